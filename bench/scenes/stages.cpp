// Where our time goes: the library's step, watched by a clock. It knows the inside of the library, and is kept apart
// from what only uses it.
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
            maker_.make(s, [&](const auto& it, const auto& def) {
                static_cast<void>(physics::detail::create_shape(s_, ids_.back(), it, def));
            });
    }
    void drive(int body, const triple& velocity, const triple& spin) override {
        s_.bodies[ids_[static_cast<std::size_t>(body)].index].velocity = {to_vec<S, D>(velocity), to_spin<S, D>(spin)};
    }
    void step(double dt) override {
        const stopwatch clock;
        double last = 0;
        const auto lap = [&](physics::detail::step_stage ended) {
            const double now = clock.ns();
            ns_[static_cast<std::size_t>(ended)] += now - last;
            last = now;
        };
        physics::detail::report(physics::detail::step<plan>(s_, s_.step, static_cast<S>(dt), {}, lap));
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
    [[nodiscard]] double contact_bytes() const override {
        return bytes_a_contact(static_cast<const physics::detail::state<plan>&>(s_));
    }
    [[nodiscard]] std::vector<std::pair<std::string, double>> stages() const override {
        static constexpr const char* names[] = {"find pairs", "find contacts", "make batches",
                                                "solve",      "place shapes",  "finish"};
        std::vector<std::pair<std::string, double>> result;
        for (std::size_t i = 0; i < ns_.size(); ++i) result.emplace_back(names[i], ns_[i]);
        return result;
    }

private:
    using plan = typename physics::detail::plan_of<lineup<S, D, Solver>>::type;

    physics::detail::world_data<plan> s_;
    std::vector<physics::body_id> ids_;
    shape_maker<S, D> maker_;
    std::array<double, 6> ns_ = {};
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
