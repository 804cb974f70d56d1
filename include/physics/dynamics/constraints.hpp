// What a solver solves: the contacts and the joints of some islands.
#pragma once

#include "physics/dynamics/graph.hpp"
#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

namespace solver_api {

/// A joint in a step.
template <class Joint, class S, int D>
struct step_joint {
    const Joint* joint;
    /// Where its bodies are as the step begins.
    detail::frames_for<Joint, S, D> start;
    /// What its rows gave in a substep of that length (N s, s); 0 of joints that are new.
    [[no_unique_address]] detail::fixed_list<S, Joint::row_count> impulse{};
    S substep{};
    /// Which of the world's joints of its kind it is.
    std::uint32_t slot = 0;
    /// Of joints that count their turns.
    [[no_unique_address]] detail::angle_list<Joint, S> turned{};
    /// What its rows gave in all substeps of a step (N s).
    [[no_unique_address]] detail::fixed_list<S, Joint::row_count> sum{};
};

/// Joints of a kind that a solver is to solve, of a longer list.
template <class Joint, class S, int D>
class joint_list {
public:
    /// Edges of these numbers, of which `first` is that of the first joint of the list; and their bodies.
    joint_list(step_joint<Joint, S, D>* all, const std::uint32_t* numbers, std::uint32_t first, const body_pair* bodies,
               std::uint32_t count)
        : all_(all), numbers_(numbers), first_(first), bodies_(bodies), count_(count) {}

    [[nodiscard]] std::uint32_t size() const { return count_; }
    step_joint<Joint, S, D>& operator[](std::uint32_t i) const { return all_[numbers_[i] - first_]; }
    /// The bodies of a joint, by their numbers among those that the solver sees.
    [[nodiscard]] const body_pair& bodies(std::uint32_t i) const { return bodies_[i]; }

private:
    step_joint<Joint, S, D>* all_;
    const std::uint32_t* numbers_;
    std::uint32_t first_;
    const body_pair* bodies_;
    std::uint32_t count_;
};

/// All that holds the bodies of some islands together: contacts, see contact_constraints, and a list of each kind of
/// joints. A solver that does not know joints finds them solved by a joint_solver.
template <class S, int D, class Features = without<>, class Joints = joints<>>
class constraints;
template <class S, int D, class Features, template <class, int> class... Joints>
class constraints<S, D, Features, joints<Joints...>> : public contact_constraints<S, D, Features>,
                                                       public joint_list<Joints<S, D>, S, D>... {
public:
    using contacts = contact_constraints<S, D, Features>;
    static constexpr int joint_kinds = sizeof...(Joints);

    constraints(const contacts& c, const joint_list<Joints<S, D>, S, D>&... lists)
        : contacts(c), joint_list<Joints<S, D>, S, D>(lists)... {}
    using contacts::size, contacts::bodies, contacts::operator[];

    template <class Joint>
    [[nodiscard]] const joint_list<Joint, S, D>& joints_of_kind() const {
        return *this;
    }
};

}  // namespace solver_api

namespace detail {

/// Which bodies have joints; null where there are contacts only.
template <class S, int D, class Features, bool Rotates>
const bool* bodies_of_joints(const solver_api::contact_constraints<S, D, Features>&,
                             const solver_bodies<S, D, Rotates>&, arena&) {
    return nullptr;
}
template <class S, int D, class Features, template <class, int> class... Joints, bool Rotates>
const bool* bodies_of_joints(const solver_api::constraints<S, D, Features, joints<Joints...>>& of,
                             const solver_bodies<S, D, Rotates>& bodies, arena& scratch) {
    if ((of.template joints_of_kind<Joints<S, D>>().size() + ...) == 0) return nullptr;
    auto* const result = scratch.allocate<bool>(bodies.count);
    for (std::uint32_t k = 0; k < bodies.count; ++k) result[k] = false;
    const auto mark = [&](const auto& list) {
        for (std::uint32_t i = 0; i < list.size(); ++i)
            for (const std::uint32_t k : {list.bodies(i).a, list.bodies(i).b})
                result[k] = bodies[k].inverse_mass > inverse_of<S>(0);
    };
    (mark(of.template joints_of_kind<Joints<S, D>>()), ...);
    return result;
}

/// Which bodies that can be pushed have contacts.
template <class S, int D, class Features, bool Rotates>
const bool* bodies_of_contacts(const solver_api::contact_constraints<S, D, Features>& of,
                               const solver_bodies<S, D, Rotates>& bodies, arena& scratch) {
    auto* const result = scratch.template allocate<bool>(bodies.count);
    for (std::uint32_t k = 0; k < bodies.count; ++k) result[k] = false;
    for (std::uint32_t i = 0; i < of.size(); ++i)
        for (const std::uint32_t k : {of.bodies(i).a, of.bodies(i).b})
            result[k] = bodies[k].inverse_mass > inverse_of<S>(0);
    return result;
}

}  // namespace detail

PHYSICS_HPP_END
