// Where our time goes: the library's step with a clock between its stages. It knows the inside of the library, and is
// kept apart from what only uses it.
#include <array>

#include "../timing.hpp"
#include "ours.hpp"

namespace bench {

namespace {

template <class S, int D, class Solver>
class staged final : public engine {
public:
    void begin(const scene& s) override { s_.settings = settings_for<decltype(s_.settings)>(s); }
    void add(const body& b) override {
        ids_.push_back(physics::detail::create_body(s_, def_of<S, D>(b)));
        for (const shape& s : b.shapes)
            make_shape<S, D>(s, [&](const auto& it, const auto& def) {
                static_cast<void>(physics::detail::create_shape(s_, ids_.back(), it, def));
            });
    }
    void drive(int body, const triple& velocity, const triple& spin) override {
        s_.bodies[ids_[static_cast<std::size_t>(body)].index].velocity = {to_vec<S, D>(velocity), to_spin<S, D>(spin)};
    }
    /// As physics::detail::step.
    void step(double dt) override {
        namespace in = physics::detail;
        const auto h = static_cast<S>(dt);
        laps lap(ns_);
        in::crew alone;
        in::start_step(s_, alone);
        in::watch_fast_bodies(s_, h);
        in::number_movers(s_);
        const auto& pairs = in::find_pairs(s_);
        lap.take(0);
        fine_ = in::find_contacts(s_, pairs, alone) && fine_;
        if (in::disturb_sleepers(s_, h)) fine_ = in::find_contacts_of_woken(s_, alone) && fine_;
        lap.take(1);
        in::inherit_contacts(s_, alone);
        lap.take(2);
        in::motion<plan> moving(s_, h, alone);
        lap.take(3);
        fine_ = moving.solve(alone) && fine_;
        lap.take(4);
        if (fine_) sweep_fast_bodies(s_, moving.moved(), h);
        fine_ = fine_ && moving.place_shapes();
        lap.take(5);
        if (fine_) moving.finish();
        lap.take(6);
    }
    void read(std::vector<state>& states) const override {
        states.clear();
        for (const physics::body_id id : ids_) {
            const auto& b = s_.bodies[id.index];
            states.push_back({from_vec<S, D>(b.pose().position), from_rotation<S, D>(b.rotation),
                              from_vec<S, D>(b.velocity.linear), from_spin<S, D>(b.velocity.angular),
                              static_cast<double>(b.mass.mass)});
        }
    }
    [[nodiscard]] triple gravity() const override { return from_vec<S, D>(s_.settings.gravity); }
    [[nodiscard]] int contacts() const override { return static_cast<int>(s_.contacts.size()); }
    [[nodiscard]] std::vector<std::pair<std::string, double>> stages() const override {
        static constexpr const char* names[] = {"find pairs",    "find contacts", "inherit impulses", "make batches",
                                                "solve",         "place shapes",  "finish"};
        std::vector<std::pair<std::string, double>> result;
        for (std::size_t i = 0; i < ns_.size(); ++i) result.emplace_back(names[i], ns_[i]);
        return result;
    }

private:
    using plan = typename physics::detail::plan_of<lineup<S, D, Solver>>::type;

    class laps {
    public:
        explicit laps(std::array<double, 7>& ns) : ns_(ns) {}
        void take(std::size_t stage) {
            const double now = clock_.ns();
            ns_[stage] += now - last_;
            last_ = now;
        }

    private:
        std::array<double, 7>& ns_;
        stopwatch clock_;
        double last_ = 0;
    };

    physics::detail::state<plan> s_;
    std::vector<physics::body_id> ids_;
    std::array<double, 7> ns_ = {};
    bool fine_ = true;
};

const enlisted here({.name = "ours-staged",
                     .settings = "as ours, with a clock between the stages; contacts include those that only come near",
                     .order = 3,
                     .make = [](int dimension) -> std::unique_ptr<engine> {
                         if (dimension == 2) return std::make_unique<staged<float, 2, physics::soft_step>>();
                         return std::make_unique<staged<float, 3, physics::soft_step>>();
                     },
                     .on_demand = true});

}  // namespace

}  // namespace bench
