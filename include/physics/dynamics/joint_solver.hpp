// Joints for solvers: what a solver calls around its work on contacts, and need not know any joint for.
#pragma once

#include "physics/dynamics/colours.hpp"
#include "physics/dynamics/direct_joints.hpp"
#include "physics/dynamics/joint_block.hpp"
#include "physics/dynamics/joint_inertias.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Some joints of a list, and by bits which of their rows are on.
template <class Joint, class S, int D>
struct joint_selection {
    const joint_list<Joint, S, D>& all;
    const std::uint32_t *which, *on;
    std::uint32_t count;

    [[nodiscard]] std::uint32_t size() const { return count; }
    step_joint<Joint, S, D>& operator[](std::uint32_t i) const { return all[which[i]]; }
    [[nodiscard]] const body_pair& bodies(std::uint32_t i) const { return all.bodies(which[i]); }
};

/// Joints of a kind, in blocks by colours.
template <class Joint, class S, int D, bool Rotates, int W>
class joint_blocks {
    using block = joint_block<Joint, S, D, Rotates, W>;

public:
    void make(const joint_selection<Joint, S, D>& joints, solver_bodies<S, D, Rotates> bodies, S h, arena& scratch,
              task_runner& tasks) {
        const auto always = [](const auto&, std::uint32_t) { return true; };
        const colours_of_contacts colours = colour_edges(joints, always, bodies, nullptr, scratch, tasks);
        blocks_ = blocks_by_colour(colours, W);
        first_ = scratch.template allocate<block>(blocks_.count());
        // Blocks have the rows that are on in any of their lanes.
        auto* const on = scratch.template allocate<std::uint32_t>(blocks_.count());
        auto* const rows = scratch.template allocate<row*>(blocks_.count());
        for (std::uint32_t group = 0; group < blocks_.colours; ++group)
            for (std::uint32_t k = blocks_.begin[group]; k < blocks_.begin[group + 1]; ++k) {
                on[k] = 0;
                each_lane(colours, k, group, [&](int, std::uint32_t i) { on[k] |= joints.on[i]; });
                rows[k] = scratch.template allocate<row>(static_cast<std::uint32_t>(std::popcount(on[k])));
            }
        blocks_.each_at_once(tasks, [&](std::uint32_t k, std::uint32_t group, std::uint32_t) {
            block& to = *new (first_ + k) block(on[k], rows[k]);
            for (int lane = 0; lane < W; ++lane) to.put_nothing(lane, bodies.dummy_body());
            each_lane(colours, k, group,
                      [&](int lane, std::uint32_t i) { to.put(lane, joints[i], joints.bodies(i), bodies.first, h); });
            to.note_sides(bodies.first);
        });
    }
    template <class F>
    void each(task_runner& tasks, F&& f, bool back = false) const {
        blocks_.each(
            tasks, [&](std::uint32_t k) { f(first_[k]); }, back);
    }

private:
    using row = typename block::row_type;

    /// f(lane, joint) for the joints of a block of that colour.
    template <class F>
    void each_lane(const colours_of_contacts& colours, std::uint32_t k, std::uint32_t group, F&& f) const {
        const std::uint32_t lanes = blocks_.lanes_of(group), end = colours.begin[group + 1];
        std::uint32_t at = colours.begin[group] + (k - blocks_.begin[group]) * lanes;
        for (std::uint32_t lane = 0; lane < lanes && at < end; ++lane, ++at)
            f(static_cast<int>(lane), colours.order[at]);
    }

    blocks_by_colour blocks_;
    block* first_;
};

/// The joints of some constraints that are solved directly, in groups of W components with the same pattern.
template <class Constraints, int W>
class direct_groups;
template <class S, int D, class Features, template <class, int> class... Joints, int W>
class direct_groups<constraints<S, D, Features, joints<Joints...>>, W> {
    static constexpr bool rotates = Features::rotation, two = (has_two_directions<Joints<S, D>>() || ...);
    template <int Width>
    using group = direct_joints<S, D, rotates, Width, two>;
    using access = joint_access<S, D, rotates, two>;
    using constraints_type = constraints<S, D, Features, joints<Joints...>>;

public:
    /// Of each kind which joints are left to be solved otherwise: f(kind, numbers, rows that are on, count).
    template <class F>
    void make(const constraints_type& of, solver_bodies<S, D, rotates> bodies, const joint_pose<S, D, rotates>* poses,
              std::uint32_t max_cost, S h, arena& scratch, F&& rest) {
        const std::uint32_t count = (of.template joints_of_kind<Joints<S, D>>().size() + ...);
        if (count == 0) return;
        auto* const all = scratch.template allocate<graph_joint>(count);
        auto* const steps = scratch.template allocate<void*>(count);
        std::uint32_t at = 0, kind = 0;
        const auto list = [&]<class Joint>(const joint_list<Joint, S, D>& joints) {
            kinds_[kind] = access::template of<Joint>();
            for (std::uint32_t i = 0; i < joints.size(); ++i, ++at) {
                const body_pair& ends = joints.bodies(i);
                const auto &a = bodies[ends.a], &b = bodies[ends.b];
                steps[at] = &joints[i];
                new (all + at) graph_joint{
                    ends, a.inverse_mass > inverse_of<S>(0), b.inverse_mass > inverse_of<S>(0), kind, i, 0, 0, 0};
                if (holds_points_only(*joints[i].joint)) {
                    all[at].rows = point_rows_of<Joint>();
                    continue;
                }
                row_list<S, D, Joint::row_count, has_two_directions<Joint>()> list_of_rows;
                const auto rows = list_of_rows.target().row;
                write_rows(joints[i], true, poses[ends.a], poses[ends.b], list_of_rows.target());
                for (int k = 0; k < Joint::row_count; ++k) {
                    if (!rows[k].is_on()) continue;
                    all[at].rows |= 1u << k;
                    if (rows[k].is_spring()) all[at].springs |= 1u << k;
                    if (rows[k].is_bounded()) all[at].bounded |= 1u << k;
                }
            }
            ++kind;
        };
        (list(of.template joints_of_kind<Joints<S, D>>()), ...);
        const joint_patterns& patterns = *new (scratch.template allocate<joint_patterns>(1))
                                             joint_patterns(all, count, bodies.count, max_cost, scratch);
        bool* const is_direct = scratch.template allocate<bool>(count);
        for (std::uint32_t i = 0; i < count; ++i) is_direct[i] = false;
        bool* const taken = scratch.template allocate<bool>(patterns.size());
        for (std::uint32_t i = 0; i < patterns.size(); ++i) taken[i] = patterns[i].pattern == nullptr;
        const bool* const has_contacts = bodies_of_contacts(of, bodies, scratch);
        groups_ = scratch.template allocate<group<W>*>(patterns.size());
        alone_ = scratch.template allocate<group<1>*>(patterns.size());
        for (std::uint32_t i = 0; i < patterns.size(); ++i) {
            if (taken[i]) continue;
            const joint_patterns::component* lane[W] = {};
            int used = 0;
            for (std::uint32_t k = i; k < patterns.size() && used < W; ++k) {
                if (taken[k] || patterns[k].pattern != patterns[i].pattern) continue;
                taken[k] = true;
                lane[used++] = &patterns[k];
                for (std::uint32_t n = 0; n < patterns[k].count; ++n)
                    is_direct[patterns.order()[patterns[k].first + n]] = true;
            }
            const auto number = [&](int l, std::uint32_t n) { return patterns.order()[lane[l]->first + n]; };
            const auto make = [&]<class Group>(Group*& to) {
                to = new (scratch.template allocate<Group>(1)) Group(
                    *patterns[i].pattern, used, kinds_, [&](int l, std::uint32_t n) { return steps[number(l, n)]; },
                    [&](int l, std::uint32_t n) { return all[number(l, n)].ends; }, bodies.first, bodies.dummy_body(),
                    h, scratch);
                for (int l = 0; l < used; ++l)
                    for (std::uint32_t n = 0; n < lane[l]->count; ++n) {
                        const body_pair& ends = all[number(l, n)].ends;
                        if (has_contacts[ends.a] || has_contacts[ends.b]) to->touch(l);
                    }
            };
            // One with no like would leave all lanes but one unused.
            if (used > 1 || W == 1) make(groups_[count_++]);
            else make(alone_[alone_count_++]);
        }
        if constexpr (rotates) raise_inertias(all, steps, is_direct, count, kinds_, bodies, poses, h, scratch);
        at = 0;
        for (std::uint32_t k = 0; k < sizeof...(Joints); ++k) {
            auto* const left = scratch.template allocate<std::uint32_t>(count);
            auto* const on = scratch.template allocate<std::uint32_t>(count);
            std::uint32_t n = 0;
            for (; at < count && all[at].kind == k; ++at) {
                if (is_direct[at]) continue;
                left[n] = all[at].number;
                on[n++] = all[at].rows;
            }
            rest(k, left, on, n);
        }
    }
    template <class F>
    void each(task_runner& tasks, F&& f) const {
        tasks.parallel_for(count_ + alone_count_, 1, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t k = first; k < end; ++k) {
                if (k < count_) f(*groups_[k]);
                else f(*alone_[k - count_]);
            }
        });
    }

private:
    access kinds_[sizeof...(Joints)];
    group<W>** groups_ = nullptr;
    group<1>** alone_ = nullptr;
    std::uint32_t count_ = 0, alone_count_ = 0;
};

}  // namespace detail

namespace solver_api {

/// Solves the joints among some constraints, Width at a time; every width gives the same bits, and so does every number
/// of workers. A solver makes one as its step begins, and calls in each substep warm_start once velocities have
/// advanced, solve_speeds and correct, update_rows once poses have, and relax; in the end store_impulses. Rows are
/// written where bodies are after each of their moves, so that no pair of forces has a moment: that keeps angular
/// momentum. Costs nothing where there are no joints.
///
/// Joints that are not solved directly are visited one by one, from the first to the last or back. What a substep
/// leaves of an error of speeds, E, has to be that of passes that read the same from either end, relax included: with
/// impulses kept from substep to substep the error turns by [[E, E], [E - 1, E]], which is stable where eigenvalues of
/// E lie in 0..1, as those of such passes do, and not always where they are complex: nets of heavy and light bodies
/// would gain speed. Impulses of correct are taken back once bodies have moved, so that speeds know nothing of them.
template <class Constraints, int Width = 1>
class joint_solver;
template <class S, int D, class Features, template <class, int> class... Joints, int Width>
class joint_solver<constraints<S, D, Features, joints<Joints...>>, Width>
    : detail::joint_blocks<Joints<S, D>, S, D, Features::rotation, Width>... {
    template <class Joint>
    using blocks = detail::joint_blocks<Joint, S, D, Features::rotation, Width>;

public:
    using constraints_type = constraints<S, D, Features, joints<Joints...>>;
    using bodies_type = solver_bodies<S, D, Features::rotation>;
    static constexpr bool rotates = Features::rotation;

    /// For substeps of h seconds; rigid joints take errors back as springs of that frequency (Hz) and damping ratio
    /// would, but do not sag. A motion that has find_rotation(body, pose, velocity, h) is asked how bodies are turned.
    /// Joints are solved directly where that takes up to max_direct_cost multiplications a row. Of bodies of others
    /// inertias are raised for the step, see raise_inertias: contacts are to be prepared after that.
    template <class Motion>
    joint_solver(const constraints_type& of, bodies_type bodies, const Motion& motion, S h, S frequency,
                 S damping_ratio, int max_direct_cost, arena& scratch, detail::task_runner& tasks)
        : bodies_(bodies),
          poses_of_(bodies, motion),
          poses_(scratch.allocate<detail::joint_pose<S, D, rotates>>(bodies.count)),
          pass_{h, S(1) / h, detail::softness<S>::of(frequency, damping_ratio, h)} {
        find_poses(tasks);
        const std::uint32_t *which[sizeof...(Joints)] = {}, *on[sizeof...(Joints)] = {};
        std::uint32_t counts[sizeof...(Joints)] = {}, kind = 0;
        direct_.make(
            of, bodies, poses_, static_cast<std::uint32_t>(max_direct_cost), h, scratch,
            [&](std::uint32_t k, const std::uint32_t* numbers, const std::uint32_t* rows, std::uint32_t count) {
                which[k] = numbers;
                on[k] = rows;
                counts[k] = count;
            });
        ((make_blocks<Joints<S, D>>(of, which[kind], on[kind], counts[kind], bodies, scratch, tasks), ++kind), ...);
    }
    /// Gives bodies what the last substep gave.
    void warm_start(detail::task_runner& tasks) {
        each(tasks, [this](auto& b) { b.warm_start(bodies_.first, poses_, pass_); });
    }
    /// Says that bodies have moved. A solver that gives them in the next substep all that they have got in this one,
    /// v - start_velocity, hands these in, and does not warm-start again: what joints gave turns with them.
    void update_rows(detail::task_runner& tasks, twist_of<S, D, Features::rotation>* start_velocity) {
        find_poses(tasks);
        each(tasks, [=, this](auto& b) { b.update_rows(bodies_.first, poses_, pass_, start_velocity); });
    }
    /// Speeds and springs, from the first joint to the last or back; true if there are kinds of them.
    bool solve_speeds(detail::task_runner& tasks, bool back) { return solve(tasks, detail::joint_round::speeds, back); }
    /// Then, before bodies move, the errors.
    bool correct(detail::task_runner& tasks, bool back) { return solve(tasks, detail::joint_round::corrections, back); }
    /// Speeds where bodies are after the move, without springs. Of so many passes of solve_speeds, there and back in
    /// turn, it makes ones that read the same from either end: by a pass back, and where they are even one before it.
    bool relax(detail::task_runner& tasks, int passes) {
        if (passes % 2 == 0) solve_iterative(tasks, detail::joint_round::relaxing_first, false);
        return solve(tasks, detail::joint_round::relaxing, true);
    }
    /// The same as solve_speeds and correct around one pass over contacts: joints that are solved directly hold exactly
    /// when bodies move, whatever contacts do. The first call costs these nothing where there are no contacts.
    void solve_before_contacts(detail::task_runner& tasks) {
        solve_direct(tasks, detail::joint_round::before_contacts);
        solve_iterative(tasks, detail::joint_round::speeds, false);
    }
    void solve_after_contacts(detail::task_runner& tasks) {
        solve_iterative(tasks, detail::joint_round::corrections, false);
        solve_direct(tasks, detail::joint_round::all);
    }
    void store_impulses(detail::task_runner& tasks) {
        each(tasks, [this](auto& b) { b.store_impulses(poses_, pass_.h); });
    }

private:
    bool solve(detail::task_runner& tasks, detail::joint_round round, bool back) {
        solve_direct(tasks, round);
        solve_iterative(tasks, round, back);
        return true;
    }
    void solve_direct(detail::task_runner& tasks, detail::joint_round round) {
        direct_.each(tasks, [=, this](auto& b) { b.solve(bodies_.first, poses_of_, pass_, round); });
    }
    void solve_iterative(detail::task_runner& tasks, detail::joint_round round, bool back) {
        const auto of_kind = [&]<class Joint>(const blocks<Joint>& all) {
            all.each(
                tasks, [=, this](auto& b) { b.solve(bodies_.first, pass_, round, back); }, back);
            return 0;
        };
        // What is assigned last is evaluated first.
        [[maybe_unused]] int last = 0;
        if (back) (void)(last = ... = of_kind.template operator()<Joints<S, D>>(*this));
        else (of_kind.template operator()<Joints<S, D>>(*this), ...);
    }
    template <class Joint>
    void make_blocks(const constraints_type& of, const std::uint32_t* which, const std::uint32_t* on,
                     std::uint32_t count, bodies_type bodies, arena& scratch, detail::task_runner& tasks) {
        blocks<Joint>::make({of.template joints_of_kind<Joint>(), which, on, count}, bodies, pass_.h, scratch, tasks);
    }
    template <class F>
    void each(detail::task_runner& tasks, F&& f) {
        direct_.each(tasks, [&](auto& b) { f(b); });
        (blocks<Joints<S, D>>::each(tasks, [&](auto& b) { f(b); }), ...);
    }

    void find_poses(detail::task_runner& tasks) {
        tasks.parallel_for(bodies_.count, min_per_task, [this](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t k = first; k < end; ++k)
                new (poses_ + k) detail::joint_pose<S, D, rotates>(poses_of_.of(k));
        });
    }

    /// The smallest number of bodies that makes a task.
    static constexpr std::uint32_t min_per_task = 128;

    bodies_type bodies_;
    detail::joint_poses<S, D, rotates> poses_of_;
    detail::joint_pose<S, D, rotates>* poses_;
    detail::joint_pass<S> pass_;
    detail::direct_groups<constraints_type, Width> direct_;
};
/// The same where there are contacts only.
template <class S, int D, class Features, int Width>
class joint_solver<contact_constraints<S, D, Features>, Width> {
public:
    template <class... Input>
    explicit joint_solver(const Input&...) {}
    void warm_start(detail::task_runner&) {}
    void update_rows(detail::task_runner&, twist_of<S, D, Features::rotation>*) {}
    bool relax(detail::task_runner&, int) { return false; }
    void solve_before_contacts(detail::task_runner&) {}
    void solve_after_contacts(detail::task_runner&) {}
    bool solve_speeds(detail::task_runner&, bool) { return false; }
    bool correct(detail::task_runner&, bool) { return false; }
    void store_impulses(detail::task_runner&) {}
};

}  // namespace solver_api

PHYSICS_HPP_END
