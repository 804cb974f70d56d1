// A lockstep duel: two peers exchange inputs alone, guess those that are late, roll back, and compare hashes.
#include <physics.hpp>

#include <array>
#include <cstdint>

#include "filming.hpp"

namespace {

struct duel
    : physics::recipe<float, 2, physics::shapes<physics::ball, physics::box>, physics::events<physics::event::hit>> {};
using world = physics::world<duel>;
using vec = world::vec;

/// What a player holds down.
struct input {
    int x = 0, y = 0;
    friend bool operator==(const input&, const input&) = default;
};
/// What a player does in a frame: anything, for a quarter of a second each.
input input_of(int player, int frame) {
    std::uint32_t mix = static_cast<std::uint32_t>(player + 2 * (frame / 15) + 1) * 0x9e3779b1u;
    mix = (mix ^ mix >> 15) * 0x85ebca6bu;
    return {static_cast<int>((mix >> 9) % 3) - 1, static_cast<int>((mix >> 17) % 3) - 1};
}

using inputs = std::array<input, 2>;

/// The game: nothing goes in but inputs.
struct game {
    world arena{{.gravity = {}}};
    physics::body_id players[2];

    game() {
        const physics::body_id walls = arena.create_body({.type = physics::body_type::static_body});
        for (const float side : {-1.0f, 1.0f}) {
            arena.create_shape(walls, world::box{{0.5f, 6}}, {.position = {8.5f * side, 0}});
            arena.create_shape(walls, world::box{{9, 0.5f}}, {.position = {0, 5.5f * side}});
            physics::body_id& player = players[side < 0 ? 0 : 1];
            player = arena.create_body({.position = {5 * side, 0}, .linear_damping = 1, .angular_damping = 1});
            arena.create_shape(player, world::box{{0.5f, 0.5f}}, {.density = 2, .material = {.restitution = 0.4f}});
        }
        for (int i = 0; i < 12; ++i) {
            const vec at = {static_cast<float>(i % 3) - 1, static_cast<float>(i / 3) * 1.6f - 2.4f};
            const physics::body_id ball = arena.create_body({.position = at, .linear_damping = 0.3f});
            arena.create_shape(ball, world::ball{0.3f}, {.material = {.restitution = 0.8f}});
        }
    }
    void push(const inputs& now) {
        for (std::size_t i = 0; i < 2; ++i)
            arena.apply_force(players[i], vec{static_cast<float>(now[i].x), static_cast<float>(now[i].y)} * 24.0f);
    }
    void step(const inputs& now) {
        push(now);
        arena.step(1.0f / 60);
    }
};

/// How many frames an input is on its way.
constexpr int delay = 8;

/// One of two machines. It knows its own inputs at once, and the other's after the delay.
class peer {
public:
    explicit peer(int me) : me_(static_cast<std::size_t>(me)) {}

    int rollbacks = 0, hits = 0;

    void advance(int frame) {
        simulate(frame);
        const int known = frame - delay;
        if (known < 0) return;
        last_known_ = input_of(static_cast<int>(1 - me_), known);
        if (!(at(known).used[1 - me_] == last_known_)) {
            ++rollbacks;
            now_ = at(known).before;
            for (int f = known; f <= frame; ++f) simulate(f);
        }
        // What happened in it is told now, and not before: it will not be played again.
        hits += at(known).hits;
    }
    /// After a frame whose inputs are all known.
    [[nodiscard]] std::uint64_t hash_after(int frame) { return at(frame).hash; }

private:
    struct record {
        game before;
        inputs used;
        std::uint64_t hash = 0;
        int hits = 0;
    };
    record& at(int frame) { return history_[static_cast<std::size_t>(frame % (delay + 1))]; }
    /// With what it knows: that the other goes on as it did when it was last heard of.
    void simulate(int frame) {
        record& r = at(frame);
        r.before = now_;
        r.used[me_] = input_of(static_cast<int>(me_), frame);
        r.used[1 - me_] = last_known_;
        now_.step(r.used);
        r.hash = now_.arena.state_hash();
        r.hits = static_cast<int>(now_.arena.hit_events().size());
    }

    std::size_t me_;
    game now_;
    input last_known_ = input_of(static_cast<int>(1 - me_), 0);
    std::array<record, delay + 1> history_;
};

}  // namespace

int main() {
    samples::film film("Lockstep", "what both peers play, with inputs eight frames late", "samples/out/lockstep.html");
    // Played with all inputs known: what both must come to.
    game truth;
    peer peers[2] = {peer(0), peer(1)};
    std::array<std::uint64_t, delay + 1> hashes{};
    std::array<int, delay + 1> hits{};
    int frame = 0, compared = 0, equal[2] = {}, all_hits = 0;
    film.play(
        "duel", truth.arena, {}, 30,
        [&](double) {
            truth.push({input_of(0, frame), input_of(1, frame)});
        },
        [&] {
            const auto place = [](int f) { return static_cast<std::size_t>(f % (delay + 1)); };
            hashes[place(frame)] = truth.arena.state_hash();
            hits[place(frame)] = static_cast<int>(truth.arena.hit_events().size());
            for (peer& p : peers) p.advance(frame);
            if (const int known = frame - delay; known >= 0) {
                ++compared;
                all_hits += hits[place(known)];
                for (int i = 0; i < 2; ++i) equal[i] += peers[i].hash_after(known) == hashes[place(known)];
            }
            ++frame;
        });
    film.expect("frames whose hash one peer has as it should be", equal[0], compared);
    film.expect("and the other peer", equal[1], compared);
    film.expect("rollbacks of one peer", peers[0].rollbacks, 50, 200);
    film.expect("and of the other one", peers[1].rollbacks, 50, 200);
    film.expect("hits that one peer told of", peers[0].hits, all_hits);
    film.expect("and the other one", peers[1].hits, all_hits);
    return film.finish();
}
