// Dice: six rounded boxes are thrown on felt, and read when all sleep; 10,000 throws, and how even their faces are.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "filming.hpp"

namespace {

struct tray_of_dice : physics::recipe<float, 3, physics::shapes<physics::rounded_box, physics::halfspace>> {};
using world = physics::world<tray_of_dice>;
using vec = world::vec;
using rotation = physics::rotation<float, 3>;

constexpr int dice = 6;
// 16 mm, in units of a centimetre, so that lengths are about 1: gravity is in cm/s^2.
constexpr float side = 1.6f, round_edge = 0.2f, tray = 8;

/// Numbers from 0 to 1, the same on any machine.
class random_numbers {
public:
    float operator()() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<float>(state_ >> 40) / static_cast<float>(1 << 24);
    }
    float between(float low, float high) { return low + (high - low) * (*this)(); }

private:
    std::uint64_t state_ = 1;
};

class game {
public:
    world arena{settings()};

    game() {
        const physics::body_id walls = arena.create_body({.type = physics::body_type::static_body});
        const physics::material<float, 3> felt = {.friction = 0.5f, .restitution = 0.3f, .rolling_resistance = 0.02f};
        arena.create_shape(walls, world::halfspace{}, {.material = felt});
        // Slippery, so that few lean on them.
        for (const vec& inwards : {vec{1, 0, 0}, vec{-1, 0, 0}, vec{0, 0, 1}, vec{0, 0, -1}})
            arena.create_shape(walls, world::halfspace{inwards, -tray}, {.material = {.friction = 0}});
        for (physics::body_id& die : dice_) {
            die = arena.create_body();
            arena.create_shape(die, world::rounded_box{vec::filled(side / 2 - round_edge), round_edge},
                               {.material = {.friction = 0.5f, .restitution = 0.3f}});
        }
    }
    /// From one side of the tray to the other, each turned and spun anyhow.
    void throw_all(random_numbers& random) {
        for (int i = 0; i < dice; ++i) {
            const auto anyhow = [&](float most) {
                return vec{random.between(-most, most), random.between(-most, most), random.between(-most, most)};
            };
            const vec at = {-5.5f + 2.2f * static_cast<float>(i % 2), 8 + 2.2f * static_cast<float>(i / 2 % 2),
                            -2.5f + 2.5f * static_cast<float>(i % 3)};
            arena.set_pose(dice_[i], at, any_rotation(random));
            arena.set_linear_velocity(dice_[i], vec{120, -40, 0} + anyhow(30));
            arena.set_angular_velocity(dice_[i], anyhow(40));
        }
    }
    [[nodiscard]] bool is_at_rest() const { return arena.awake_count() == 0; }
    /// All turns alike: from points of a cube that lie in a ball, in four dimensions.
    static rotation any_rotation(random_numbers& random) {
        for (;;) {
            rotation q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
            const float length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
            if (length2 < 1 && length2 > 0.01f) return normalized(q);
        }
    }
    /// The number of the face that is up, 1 to 6, and how far from level it is.
    struct reading {
        int face;
        float tilt;
    };
    [[nodiscard]] reading read(int i) const {
        const vec up = inverse_rotate(arena.rotation(dice_[i]), vec{0, 1, 0});
        reading best{0, 2};
        // Opposite faces have 7 together.
        const float along[] = {up.x, up.y, up.z, -up.z, -up.y, -up.x};
        for (int k = 0; k < 6; ++k)
            if (1 - along[k] < best.tilt) best = {k + 1, 1 - along[k]};
        best.tilt = std::sqrt(2 * std::max(best.tilt, 0.0f));
        return best;
    }

private:
    static world::settings_type settings() {
        world::settings_type s{.gravity = {0, -981, 0}};
        // Speeds in cm/s.
        s.solver.restitution_threshold = 10;
        s.sleeping.speed = 1;
        s.sleeping.drift = 0.05f;
        return s;
    }

    physics::body_id dice_[dice];
};

}  // namespace

int main(int count, char** arguments) {
    samples::film film("Dice", "six on felt, read when they sleep", "samples/out/dice.html");
    random_numbers random;
    game shown;
    int rests = 0;
    film.play("four throws", shown.arena, {}, 12, [&](double t) {
        if (std::fmod(t, 3) != 0) return;
        rests += shown.is_at_rest();
        shown.throw_all(random);
    });
    rests += shown.is_at_rest();

    const int throws = count > 1 ? std::atoi(arguments[1]) : 10000;
    game it;
    int faces[6] = {}, late = 0, flat = 0;
    long steps = 0;
    for (int i = 0; i < throws; ++i) {
        it.throw_all(random);
        int taken = 0;
        while (!it.is_at_rest() && taken < 600) {
            it.arena.step(1.0f / 60);
            ++taken;
        }
        late += taken == 600;
        steps += taken;
        for (int k = 0; k < dice; ++k) {
            const auto [face, tilt] = it.read(k);
            // As at a table, one that leans on others or on a wall does not count.
            if (tilt > 0.05f) continue;
            ++faces[face - 1];
            ++flat;
        }
    }
    const double expected = flat / 6.0;
    double chi2 = 0;
    for (int k = 0; k < 6; ++k) {
        char label[40];
        std::snprintf(label, sizeof label, "throws of a %d", k + 1);
        film.expect(label, faces[k], std::floor(expected - 5 * std::sqrt(expected)),
                    std::ceil(expected + 5 * std::sqrt(expected)));
        chi2 += (faces[k] - expected) * (faces[k] - expected) / expected;
    }
    film.expect("chi-squared of five degrees of freedom (99.9 %)", chi2, 0, 20.5);
    film.expect("throws in which a die still creeps after 10 s", late, 0, throws / 1000);
    film.expect("dice that lie flat, %", 100.0 * flat / (throws * dice), 95, 100);
    film.fact("mean time until all sleep, s", static_cast<double>(steps) / throws / 60);
    return film.finish();
}
