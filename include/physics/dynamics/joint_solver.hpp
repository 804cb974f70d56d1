// Joints for solvers: what a solver calls around its work on contacts, and need not know any joint for.
#pragma once

#include "physics/dynamics/colours.hpp"
#include "physics/dynamics/joint_block.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The joints of a kind, in blocks by colours.
template <class Joint, class S, int D, bool Rotates, int W>
class joint_blocks {
    using block = joint_block<Joint, S, D, Rotates, W>;

public:
    joint_blocks(const joint_list<Joint, S, D>& joints, solver_bodies<S, D, Rotates> bodies, S h, arena& scratch,
                 task_runner& tasks) {
        const auto always = [](const auto&, std::uint32_t) { return true; };
        const colours_of_contacts colours = colour_edges(joints, always, bodies, scratch, tasks);
        blocks_ = blocks_by_colour(colours, W);
        first_ = scratch.template allocate<block>(blocks_.count());
        blocks_.each_at_once(tasks, [&](std::uint32_t k, std::uint32_t group, std::uint32_t) {
            block& to = *new (first_ + k) block();
            const std::uint32_t lanes = blocks_.lanes_of(group), end = colours.begin[group + 1];
            std::uint32_t at = colours.begin[group] + (k - blocks_.begin[group]) * lanes;
            for (int lane = 0; lane < W; ++lane, ++at) {
                if (static_cast<std::uint32_t>(lane) < lanes && at < end)
                    to.put(lane, joints[colours.order[at]], joints.bodies(colours.order[at]), bodies.first, h);
                else to.put_nothing(lane, bodies.dummy_body());
            }
            to.note_sides(bodies.first);
        });
    }
    template <class F>
    void each(task_runner& tasks, F&& f) const {
        blocks_.each(tasks, [&](std::uint32_t k) { f(first_[k]); });
    }

private:
    blocks_by_colour blocks_;
    block* first_;
};

}  // namespace detail

namespace solver_api {

/// Solves the joints among some constraints, Width at a time; every width gives the same bits, and so does every number
/// of workers. A solver makes one as its step begins, and calls in each substep warm_start once velocities have
/// advanced, solve with bias, update_rows once poses have, and solve without bias; in the end store_impulses. Rows are
/// written where bodies are after each of their moves, so that no pair of forces has a moment: that keeps angular
/// momentum. Costs nothing where there are no joints.
template <class Constraints, int Width = 1>
class joint_solver;
template <class S, int D, class Features, template <class, int> class... Joints, int Width>
class joint_solver<constraints<S, D, Features, joints<Joints...>>, Width>
    : detail::joint_blocks<Joints<S, D>, S, D, Features::rotation, Width>... {
    template <class Joint>
    using blocks = detail::joint_blocks<Joint, S, D, Features::rotation, Width>;
    static constexpr bool any = sizeof...(Joints) > 0;

public:
    using constraints_type = constraints<S, D, Features, joints<Joints...>>;
    using bodies_type = solver_bodies<S, D, Features::rotation>;

    /// For substeps of h seconds; rigid joints are springs of that frequency (Hz) and damping ratio.
    joint_solver(const constraints_type& of, bodies_type bodies, S h, S frequency, S damping_ratio, arena& scratch,
                 detail::task_runner& tasks)
        : blocks<Joints<S, D>>(of.template joints_of_kind<Joints<S, D>>(), bodies, h, scratch, tasks)...,
          bodies_(bodies.first) {
        if constexpr (any) pass_ = {h, S(1) / h, detail::softness<S>::of(frequency, damping_ratio, h)};
    }
    /// Gives bodies what the last substep gave.
    void warm_start(detail::task_runner& tasks) {
        each(tasks, [this](auto& b) { b.warm_start(bodies_, pass_); });
    }
    /// Says that bodies have moved. A solver that gives them in the next substep all that they have got in this one,
    /// v - start_velocity, hands these in, and does not warm-start again: what joints gave turns with them.
    void update_rows(detail::task_runner& tasks, twist_of<S, D, Features::rotation>* start_velocity) {
        each(tasks, [=, this](auto& b) { b.update_rows(bodies_, pass_, start_velocity); });
    }
    /// One pass over the joints; true if there are kinds of them.
    bool solve(detail::task_runner& tasks, bool use_bias) {
        each(tasks, [=, this](auto& b) { b.solve(bodies_, pass_, use_bias); });
        return any;
    }
    void store_impulses(detail::task_runner& tasks) {
        each(tasks, [this](auto& b) { b.store_impulses(pass_.h); });
    }

private:
    template <class F>
    void each([[maybe_unused]] detail::task_runner& tasks, [[maybe_unused]] F&& f) {
        (blocks<Joints<S, D>>::each(tasks, f), ...);
    }

    solver_body<S, D, Features::rotation>* bodies_;
    detail::joint_pass<S> pass_{};
};
/// The same where there are contacts only.
template <class S, int D, class Features, int Width>
class joint_solver<contact_constraints<S, D, Features>, Width> {
public:
    template <class... Input>
    explicit joint_solver(const Input&...) {}
    void warm_start(detail::task_runner&) {}
    void update_rows(detail::task_runner&, twist_of<S, D, Features::rotation>*) {}
    bool solve(detail::task_runner&, bool) { return false; }
    void store_impulses(detail::task_runner&) {}
};

}  // namespace solver_api

PHYSICS_HPP_END
