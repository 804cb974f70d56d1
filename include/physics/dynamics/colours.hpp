// Which contacts can be solved at the same time: colours.
#pragma once

#include <bit>

#include "physics/base/task_runner.hpp"
#include "physics/dynamics/graph.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Contacts in groups of which no two push the same body, and a last group of those that found no such group.
struct colours_of_contacts {
    static constexpr std::uint32_t capacity = 64;

    /// Numbers of contacts, group by group.
    std::uint32_t* order = nullptr;
    /// Where each group begins; one more than there are groups.
    std::uint32_t begin[capacity + 1] = {};
    std::uint32_t count = 0;
    /// Whether the last group's contacts may push the same body.
    bool last_is_serial = false;
    /// Of each group, by its bit, whether its contacts push bodies of joints. Not of the last one if it is serial.
    std::uint64_t is_of_joints = 0;
};

/// Whether a contact is about to push: it has, or its surfaces overlap.
template <class S, int D, class Features>
bool is_active(const contact<S, D, Features>& c) {
    bool active = false;
    for (int k = 0; k < c.count; ++k) active |= c.points[k].substep_impulse > S(0) || !(c.points[k].separation > S(0));
    return active;
}

/// Colours edges greedily in their order, contacts or joints of a kind: first those between two bodies that can be
/// pushed, then in colours of their own those that push only A and those that push only B, so that what holds the pile
/// acts last, and all of a colour push the same sides. Those of bodies that have joints, if they are told, have colours
/// of their own too. Within a colour those that are about to push come first, so that lanes have the same to do.
/// O(contacts). Source: Catto, Solver2D (2024); greedy edge colouring.
template <class Edges, class IsActive, class S, int D, bool Rotates>
colours_of_contacts colour_edges(const Edges& edges, IsActive&& is_active, solver_bodies<S, D, Rotates> bodies,
                                 const bool* has_joint, arena& scratch, task_runner& tasks) {
    const std::uint32_t count = edges.size();
    colours_of_contacts result;
    result.order = scratch.template allocate<std::uint32_t>(count);
    const arena::mark needed = scratch.here();
    auto* used = scratch.template allocate<std::uint64_t>(bodies.count);
    // Until a contact has its colour, which sides it pushes; and with either, whether it is idle.
    auto* colour_of = scratch.template allocate<std::uint8_t>(count);
    std::uint32_t sizes[colours_of_contacts::capacity] = {}, first = 0;
    constexpr std::uint32_t serial = colours_of_contacts::capacity - 1, share = 256;
    constexpr std::uint8_t uncoloured = 128, idle = 64, jointed = 4, moves_a = 1, moves_b = 2, moves_both = 3;
    const auto is_pushed = [&](std::uint32_t i) { return bodies[i].inverse_mass > inverse_of<S>(0); };
    tasks.parallel_for(count, share, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t) {
        // Copies, as what is written may be anything to the compiler.
        const Edges all = edges;
        auto* const sides = colour_of;
        for (std::uint32_t i = begin; i < end; ++i) {
            const body_pair of = all.bodies(i);
            sides[i] = static_cast<std::uint8_t>(uncoloured | (is_active(all, i) ? 0 : idle) |
                                                 (is_pushed(of.a) ? moves_a : 0) | (is_pushed(of.b) ? moves_b : 0));
            if (has_joint != nullptr && (has_joint[of.a] || has_joint[of.b])) sides[i] |= jointed;
        }
    });
    std::uint64_t is_of_joints = 0;
    const auto colour_those_of = [&](std::uint8_t sides) {
        for (std::uint32_t i = 0; i < bodies.count; ++i) used[i] = 0;
        std::uint32_t end = first;
        for (std::uint32_t i = 0; i < count; ++i) {
            if ((colour_of[i] & ~idle) != (uncoloured | sides)) continue;
            const auto [body_a, body_b] = edges.bodies(i);
            const bool a = (sides & moves_a) != 0, b = (sides & moves_b) != 0;
            const std::uint64_t taken = (a ? used[body_a] : 0) | (b ? used[body_b] : 0);
            const auto free = static_cast<std::uint32_t>(std::countr_one(taken));
            const std::uint32_t colour = first + free < serial ? first + free : serial;
            if (colour < serial) {
                if (a) used[body_a] |= std::uint64_t{1} << free;
                if (b) used[body_b] |= std::uint64_t{1} << free;
                end = end > colour + 1 ? end : colour + 1;
            }
            colour_of[i] = static_cast<std::uint8_t>(colour | (colour_of[i] & idle));
            ++sizes[colour];
        }
        if ((sides & jointed) != 0)
            for (std::uint32_t k = first; k < end; ++k) is_of_joints |= std::uint64_t{1} << k;
        first = end;
    };
    for (const std::uint8_t sides : {moves_both, moves_a, moves_b, std::uint8_t{0}}) {
        colour_those_of(sides);
        if (has_joint != nullptr) colour_those_of(sides | jointed);
    }
    std::uint32_t place[colours_of_contacts::capacity], at = 0;
    for (std::uint32_t k = 0; k < colours_of_contacts::capacity; ++k) {
        place[k] = at;
        if (sizes[k] == 0) continue;
        result.is_of_joints |= (is_of_joints >> k & 1) << result.count;
        result.begin[result.count++] = at;
        result.last_is_serial = k == serial;
        at += sizes[k];
    }
    result.begin[result.count] = at;
    // Several workers go over contacts of the same bodies in all colours if contacts stay near others of like numbers.
    // Within a colour any order gives the same bits, but in the last one, where contacts may push the same body.
    const auto put = [&](std::uint32_t begin, std::uint32_t end, const auto& wanted) {
        for (const std::uint8_t kind : {std::uint8_t{0}, idle})
            for (std::uint32_t i = begin; i < end; ++i)
                if ((colour_of[i] & idle) == kind && wanted(colour_of[i] & ~idle))
                    result.order[place[colour_of[i] & ~idle]++] = i;
    };
    if (tasks.is_serial()) {
        put(0, count, [](std::uint32_t) { return true; });
    } else {
        const std::uint32_t chunk = count / (4 * tasks.workers()) + 1;
        for (std::uint32_t begin = 0; begin < count; begin += chunk)
            put(begin, count - begin < chunk ? count : begin + chunk, [](std::uint32_t of) { return of != serial; });
        put(0, count, [](std::uint32_t of) { return of == serial; });
    }
    scratch.rewind(needed);
    return result;
}
template <class S, int D, class Features>
colours_of_contacts colour(const contact_constraints<S, D, Features>& contacts,
                           solver_bodies<S, D, Features::rotation> bodies, const bool* has_joint, arena& scratch,
                           task_runner& tasks) {
    const auto active = [](const auto& all, std::uint32_t i) { return is_active(all[i]); };
    return colour_edges(contacts, active, bodies, has_joint, scratch, tasks);
}
template <class S, int D, class Features>
colours_of_contacts colour(const contact_constraints<S, D, Features>& contacts,
                           solver_bodies<S, D, Features::rotation> bodies, arena& scratch) {
    task_runner alone;
    return colour(contacts, bodies, nullptr, scratch, alone);
}

/// Blocks of up to so many edges of a colour, and how workers go over them.
struct blocks_by_colour {
    /// Smallest number of blocks that makes a task.
    static constexpr std::uint32_t share = 16;

    /// Where the blocks of each colour begin, and after the last one.
    std::uint32_t begin[colours_of_contacts::capacity + 1];
    std::uint32_t colours;
    std::uint32_t edges_a_block;
    bool last_is_serial;
    /// See colours_of_contacts.
    std::uint64_t is_of_joints;

    blocks_by_colour() = default;
    blocks_by_colour(const colours_of_contacts& of, int lanes)
        : colours(of.count),
          edges_a_block(static_cast<std::uint32_t>(lanes)),
          last_is_serial(of.last_is_serial),
          is_of_joints(of.is_of_joints) {
        begin[0] = 0;
        for (std::uint32_t group = 0; group < colours; ++group) {
            const std::uint32_t edges = of.begin[group + 1] - of.begin[group], size = lanes_of(group);
            begin[group + 1] = begin[group] + (edges + size - 1) / size;
        }
    }
    [[nodiscard]] std::uint32_t count() const { return begin[colours]; }
    /// Edges of a block of this colour: one where they may push the same body.
    [[nodiscard]] std::uint32_t lanes_of(std::uint32_t group) const {
        return last_is_serial && group + 1 == colours ? 1 : edges_a_block;
    }

    /// Calls f(block's number) for all, colour by colour, or from the last to the first.
    template <class F>
    void each(task_runner& tasks, const F& f, bool back = false) const {
        if (!tasks.is_serial())
            return each_in_parallel(
                tasks, &f, [](const void* of, std::uint32_t k) { (*static_cast<const F*>(of))(k); }, back);
        for (std::uint32_t k = 0; k < count(); ++k) f(back ? count() - 1 - k : k);
    }
    /// The same for those that push bodies of joints.
    template <class F>
    void each_of_joints(task_runner& tasks, F&& f) const {
        for (std::uint32_t group = 0; group < colours; ++group)
            if ((is_of_joints >> group & 1) != 0)
                tasks.parallel_for(begin[group + 1] - begin[group], share,
                                   [&](std::uint32_t start, std::uint32_t end, std::uint32_t) {
                                       for (std::uint32_t k = start; k < end; ++k) f(begin[group] + k);
                                   });
    }
    /// Calls f(block's number, colour, worker) for all of them in any order: each is for the worker that has it in the
    /// passes.
    template <class F>
    void each_at_once(task_runner& tasks, F&& f) const {
        tasks.for_each_slice(count() / share, [&](const task_runner::slice& of, std::uint32_t worker) {
            for (std::uint32_t group = 0; group < colours; ++group) {
                const std::uint32_t from = begin[group], size = begin[group + 1] - from;
                const std::uint32_t last = from + of.end_in(size);
                for (std::uint32_t k = from + of.begin_in(size); k < last; ++k) f(k, group, worker);
            }
        });
    }

private:
    /// Once for whatever there is to call, as it is called for blocks.
    void each_in_parallel(task_runner& tasks, const void* f, void (*call)(const void*, std::uint32_t),
                          bool back) const {
        for (std::uint32_t i = 0; i < colours; ++i) {
            const std::uint32_t group = back ? colours - 1 - i : i;
            const std::uint32_t from = begin[group], size = begin[group + 1] - from;
            const bool is_serial = last_is_serial && group + 1 == colours;
            tasks.parallel_for(size, is_serial ? size : share,
                               [=](std::uint32_t start, std::uint32_t end, std::uint32_t) {
                                   for (std::uint32_t k = start; k < end; ++k)
                                       call(f, from + (back ? size - 1 - k : k));
                               });
        }
    }
};

}  // namespace detail

PHYSICS_HPP_END
