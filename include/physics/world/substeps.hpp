// How many substeps contacts and joints need to give way by no more than a length.
#pragma once

#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Inverse mass (1/kg) of a body for an impulse along n at p, as it shows at q.
template <class S, int D, bool Rotates>
double inverse_mass_between([[maybe_unused]] const body<S, D, Rotates>& b, const vec<S, D>& p, const vec<S, D>& q,
                            const vec<S, D>& n) {
    if (!b.is_dynamic()) return 0;
    double sum = to_double(b.inverse_mass);
    if constexpr (Rotates) {
        const auto inverse = converted<double>(in_world(b.inverse_inertia, b.rotation));
        const auto c = to_point(b.center), normal = to_point(n);
        const auto at_p = cross(to_point(p) - c, normal), at_q = cross(to_point(q) - c, normal);
        if constexpr (D == 2) sum += at_q * inverse * at_p;
        else sum += dot(at_q, times(inverse, at_p));
    }
    return sum;
}
/// The largest acceleration (m/s^2) by which what pushes in the last step would part the surfaces at any point: J M^-1
/// J^T F. Springs of omega hold it by giving way by its omega^2-th part.
template <class Plan>
double largest_load(const state<Plan>& s) {
    double largest = 0;
    if (!(s.step_lengths.usual > typename Plan::scalar(0))) return 0;
    for (const auto& c : contact_range<Plan>(s)) {
        const auto &a = s.bodies[c.body_a.index], &b = s.bodies[c.body_b.index];
        for (int i = 0; i < c.count; ++i) {
            if (!(c.points[i].normal_impulse > typename Plan::scalar(0))) continue;
            double sum = 0;
            for (int k = 0; k < c.count; ++k) {
                const auto &p = c.points[k].position, &q = c.points[i].position;
                sum += to_double(c.points[k].normal_impulse) *
                       (inverse_mass_between(a, p, q, c.normal) + inverse_mass_between(b, p, q, c.normal));
            }
            largest = max(largest, sum / to_double(s.step_lengths.usual));
        }
    }
    return largest;
}

/// J_p M^-1 J_q of two rows of a joint, as far as one of its bodies goes.
template <class S, int D, bool Rotates>
double inverse_mass_between([[maybe_unused]] const body<S, D, Rotates>& b, const vec<S, D>& along_p,
                            const vec<S, D>& along_q, [[maybe_unused]] const angular<S, D>& about_p,
                            [[maybe_unused]] const angular<S, D>& about_q) {
    if (!b.is_dynamic()) return 0;
    double sum = to_double(b.inverse_mass) * dot(to_point(along_p), to_point(along_q));
    if constexpr (Rotates) {
        const auto inverse = converted<double>(in_world(b.inverse_inertia, b.rotation));
        if constexpr (D == 2) sum += to_double(about_p) * inverse * to_double(about_q);
        else sum += dot(to_point(about_p), times(inverse, to_point(about_q)));
    }
    return sum;
}
/// The same as largest_load of one joint: of the rows that hold points together, the length of J M^-1 J^T F.
template <class Joint, class S, int D, bool Rotates>
double load_of(const stored_joint<Joint, S>& j, const body<S, D, Rotates>& a, const body<S, D, Rotates>& b) {
    constexpr bool two = has_two_directions<Joint>();
    auto at = frames_between<Joint>(a, b);
    const auto turned = count_turns(j.joint, at, j.turned);
    at.turned = turned.begin();
    row_list<S, D, Joint::row_count, two> rows;
    rows_of(j.joint, at, rows.target());
    const auto along_a = [&](int k) {
        if constexpr (two) return rows.of_a[k];
        else return rows.row[k].direction;
    };
    double squares = 0;
    for (int i = 0; i < Joint::row_count; ++i) {
        const auto& p = rows.row[i];
        if (p.direction == vec<S, D>{} || !p.is_on() || p.is_spring() || p.is_motor) continue;
        // Limits that nothing has reached.
        if (p.is_bounded() && j.sum[i] == S(0)) continue;
        double sum = 0;
        for (int k = 0; k < Joint::row_count; ++k) {
            const auto& q = rows.row[k];
            sum += to_double(j.sum[k]) * (inverse_mass_between(a, along_a(i), along_a(k), p.angular_a, q.angular_a) +
                                          inverse_mass_between(b, p.direction, q.direction, p.angular_b, q.angular_b));
        }
        squares += sum * sum;
    }
    return sqrt(squares) / to_double(j.step);
}
/// The largest of joints that were solved round by round.
template <class Plan>
double largest_joint_load([[maybe_unused]] const state<Plan>& s) {
    double largest = 0;
    if constexpr (Plan::has_joints) {
        using S = typename Plan::scalar;
        s.joints.each_kind(s.joints, [&]<class Joint>(std::uint32_t, const pool<stored_joint<Joint, S>>& of_kind) {
            if constexpr (Joint::row_count > 0)
                of_kind.each([&](std::uint32_t, const stored_joint<Joint, S>& j) {
                    const joint_record& record = s.joints.records[j.number];
                    if (record.holds() && j.is_iterated && j.step > S(0))
                        largest = max(largest, load_of(j, s.bodies[record.body_a], s.bodies[record.body_b]));
                });
        });
    }
    return largest;
}

/// Of joints, as a part of the substeps' rate; 1 where there are none.
template <class Plan>
constexpr double joint_frequency_ratio(const state<Plan>&) {
    if constexpr (Plan::has_joints) return Plan::solver::joint_frequency_ratio;
    else return 1;
}

}  // namespace detail

/// The least number of substeps at which no contact and no joint of a world gives way to what pushed or pulled in the
/// last step by more than tolerance (m), as those of the soft step do: by F / (m omega^2), omega being their part of
/// the substeps' rate. Joints that are solved directly (max_direct_cost) do not give way. Of what rests it is exact, if
/// its rounds could hold it in the last step; what lands or swings gives way further. Springs and motors are meant to.
/// At least 1; 0 if there is none, for a frequency_cap. Refuses tolerances that are not positive. O(contacts + joints).
/// Source: Catto, Soft constraints (GDC 2011).
template <class Recipe>
    requires requires(const typename world<Recipe>::settings_type& with) { with.solver.contact_frequency_ratio; }
[[nodiscard]] int substeps_for(const world<Recipe>& of, typename world<Recipe>::scalar tolerance) {
    if (!detail::check_positive("substeps_for", "tolerance", tolerance)) return 0;
    const auto& s = detail::world_access::data_of(of);
    return detail::scoped([&] {
        const auto& with = s.settings.solver;
        const auto hertz_for = [&](double load) {
            return sqrt(load / detail::to_double(tolerance)) / 6.283185307179586;
        };
        const double hertz = hertz_for(detail::largest_load(s)), cap = detail::to_double(with.frequency_cap),
                     usual = detail::to_double(s.step_lengths.usual),
                     of_joints = hertz_for(detail::largest_joint_load(s)) * usual / detail::joint_frequency_ratio(s),
                     count = max(hertz * usual / detail::to_double(with.contact_frequency_ratio), of_joints);
        if ((cap > 0 && hertz > cap) || !(count < 1e9)) return 0;
        const int below = static_cast<int>(count);
        return below < 1 ? 1 : count - below > 1e-9 ? below + 1 : below;
    });
}

PHYSICS_HPP_END
