// Continuous collision: which bodies are looked after on their way through a step, and how.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// What a body is stopped by on its way, so that it does not pass through.
enum class sweep_target : std::uint8_t {
    nothing,
    /// Shapes of static bodies.
    fixed,
    /// Shapes of all bodies.
    everything,
};

/// How a body moves in a step, and how far it may without passing anything.
template <class S, int D>
struct body_motion {
    /// Way of the centre of mass (m), and turn (rad), in 3D along its axis.
    vec<S, D> translation;
    angular<S, D> turn{};
    /// No point of a capsule's axis, of a box, of a hull without its radius... is farther from the centre of mass (m).
    S reach{};
    /// Radius of a ball that each of the body's shapes holds (m).
    S thickness{};
    /// How deep the body is in static ones as the step begins, where that is more than half the contact margin (m).
    S depth{};
    /// What the user has said of the body (see body_def::continuous).
    bool flagged = false;
    /// Surfaces that are closer as the step begins are in contact: the solver stops them (m).
    S margin{};

    /// At least as far as any point has moved, quickly.
    [[nodiscard]] constexpr S bound() const {
        S sum{};
        for (int i = 0; i < D; ++i) sum += abs(translation[i]);
        return sum + taxicab(turn) * reach;
    }
    /// How far any point but those of round edges can have moved.
    [[nodiscard]] S length() const { return physics::length(translation) + angle(turn) * reach; }

private:
    static constexpr S taxicab(S w) { return abs(w); }
    static constexpr S taxicab(const vec<S, 3>& w) { return abs(w.x) + abs(w.y) + abs(w.z); }
    static constexpr S angle(S w) { return abs(w); }
    static S angle(const vec<S, 3>& w) { return physics::length(w); }
};

/// Sweeps bodies that go farther in a step than contacts are found ahead, rotation included, or than half of what their
/// shapes are thick. They are swept against static bodies, those that the user flags against moving ones too, along
/// their straight and turning path, and stopped at the surface where they would end within something or pass into it by
/// more than half of their thickness, flagged ones also where they would graze what moves. They keep their velocity,
/// for the next step's contacts to deal with, and go on along a static surface for the rest of the step, without
/// turning. What touches already and only turns deeper, as rims of coins do, is pushed out at the end of the step
/// instead. What stops or pushes it takes from its speed the height that it gives. So they pass through nothing,
/// however thin, nothing sinks in where it lands, and what slides or rolls along a surface is not stopped. What a
/// stopped body loses is the rest of the step's time (see continuous_report). Of two bodies that are stopped on each
/// other's way, each is stopped by the path that the other would have taken. What turns by its own inertia (see
/// integrator) is taken to turn about one axis. Dynamic bodies whose middle a kinematic one may pass on the way to its
/// target count as flagged: it takes along what it meets, up to static bodies and through other dynamic ones, and gives
/// that no velocity. Cost: 100 to 400 instructions for bodies near nothing that stands; else a query and 1 to 20 us for
/// each shape on their way.
struct swept {
    using stage = physics::stage::continuous;

    template <class Space>
    struct in {
        using S = typename Space::scalar;

        [[nodiscard]] static sweep_target sweep_against(const body_motion<S, Space::dimension>& s) {
            const S through = s.thickness * S(0.5) - s.depth, maximum = through < s.margin ? through : s.margin;
            if (!(s.bound() > maximum) || !(s.length() > maximum)) return sweep_target::nothing;
            return s.flagged ? sweep_target::everything : sweep_target::fixed;
        }
    };
};

/// Looks for contacts farther ahead of bodies that go far, so that the solver stops them at what they are about to
/// meet. Costs no time of bodies and no sweeps. Its limits: the contact lies where the shapes are closest at the step's
/// start, so that a body may be held by what it would have passed by, and may pass where it turns far, or through what
/// is thin and not closest; bounces begin from where the contact was seen.
struct speculative {
    using stage = physics::stage::continuous;

    template <class Space>
    struct in {
        using S = typename Space::scalar;

        /// How much farther contacts are looked for (m).
        [[nodiscard]] static S ahead(const body_motion<S, Space::dimension>& s) {
            const S maximum = s.thickness * S(0.5);
            return s.bound() > maximum ? s.length() : S(0);
        }
    };
};

/// What the sweeps of the last step did.
template <class S>
struct continuous_report {
    /// Bodies that went far enough to be swept, and those that were stopped on their way.
    std::uint32_t swept = 0, stopped = 0;
    /// Bodies of which a sweep was given up, as it may be at hundreds of turns a step: they were stopped where they
    /// certainly had not passed.
    std::uint32_t unconverged = 0;
    /// The most time that a stopped body has lost (s).
    S lost{};
};

namespace detail {

/// For recipes without continuous collision.
struct no_continuous {
    template <class Space>
    struct in {};
};

/// Whether a policy bound to a space sweeps bodies, and whether it looks ahead.
template <class C, class S, int D>
concept sweeps = requires(const body_motion<S, D>& s) {
    { C::sweep_against(s) } -> std::same_as<sweep_target>;
};
template <class C, class S, int D>
concept looks_ahead = requires(const body_motion<S, D>& s) {
    { C::ahead(s) } -> std::same_as<S>;
};

}  // namespace detail

/// A continuous collision policy bound to a space offers one or both of
///   sweep_target sweep_against(body_motion)   what a dynamic body that has moved so is swept against
///   S ahead(body_motion)             how much farther contacts of a body that is about to move so are looked for (m)
/// as static functions. A policy is a type with `using stage = physics::stage::continuous` and such a class as
/// `in<Space>`.
template <class C, class S, int D>
concept continuous_for = detail::sweeps<C, S, D> || detail::looks_ahead<C, S, D>;

PHYSICS_HPP_END
