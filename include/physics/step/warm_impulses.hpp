// What contacts hand on from step to step where these differ in length.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A step hands on what its contacts gave, as the load that the next one begins with. Where steps differ, what a single
/// short one says of loads is noise; so what is handed on is what contacts gave within a usual step's time, to which
/// the last step adds its part. How long steps usually take follows their length by an eighth at a time. Steps of one
/// length hand on their impulses as they are, and cost nothing.
template <class S>
class warm_impulses {
public:
    /// `steps`: how many the world has taken before this one of h seconds.
    warm_impulses(const step_lengths<S>& before, std::uint64_t steps, S h)
        : last_(before.usual), steps_(steps), step_(h) {}

    /// How long steps usually take once this one counts among them (s), of a world that has taken so many.
    [[nodiscard]] S next_usual_step(std::uint64_t steps) const {
        // A world's first steps may be shorter than those to come.
        const S longest = steps < 8 ? step_ : last_ + last_ * S(0.125);
        return max(min(step_, longest), last_ - step_ * S(0.125));
    }
    /// Remembers with what impulses this step begins.
    template <class Contact>
    void before_solve(const buffer<Contact>& contacts, arena& scratch) {
        if (!is_shorter()) return;
        constexpr std::uint32_t capacity = sizeof(Contact::points) / sizeof(contacts[0].points[0]);
        begun_with_ = scratch.template allocate<S>(contacts.size() * capacity);
        S* to = begun_with_;
        for (const auto& c : contacts)
            for (int k = 0; k < c.count; ++k) *to++ = c.persisted(k) ? c.points[k].substep_impulse : S(0);
    }
    /// Turns this step's impulses into those of a usual one.
    template <class Contact>
    void after_solve(buffer<Contact>& contacts) const {
        const S usual = next_usual_step(steps_);
        if (usual == step_ && !is_shorter()) return;
        const S ratio = impulse_ratio(last_, step_), part = usual / max(step_, last_);
        const S* from = begun_with_;
        for (auto& c : contacts)
            for (int k = 0; k < c.count; ++k) {
                S& impulse = c.points[k].substep_impulse;
                if (is_shorter()) impulse += *from / ratio - *from, ++from;
                impulse *= part;
            }
    }

private:
    bool is_shorter() const { return step_ < last_; }

    S last_;
    std::uint64_t steps_;
    S step_;
    S* begun_with_ = nullptr;
};

}  // namespace detail

PHYSICS_HPP_END
