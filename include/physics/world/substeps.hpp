// How many substeps contacts need to give way by no more than a length.
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

}  // namespace detail

/// The least number of substeps at which no contact of a world gives way to what pushed in the last step by more than
/// tolerance (m), as those of the soft step do: by F / (m omega^2), omega being their part of the substeps' rate.
/// Joints do not give way. Of what rests it is exact, if its rounds could hold it in the last step; what lands gives
/// way further. At least 1; 0 if there is none, for a frequency_cap. Refuses tolerances that are not positive.
/// O(contacts). Source: Catto, Soft constraints (GDC 2011).
template <class Recipe>
    requires requires(const typename world<Recipe>::settings_type& with) { with.solver.contact_frequency_ratio; }
[[nodiscard]] int substeps_for(const world<Recipe>& of, typename world<Recipe>::scalar tolerance) {
    if (!detail::check_positive("substeps_for", "tolerance", tolerance)) return 0;
    const auto& s = detail::world_access::data_of(of);
    return detail::scoped([&] {
        const auto& with = s.settings.solver;
        const double load = detail::largest_load(s),
                     hertz = sqrt(load / detail::to_double(tolerance)) / 6.283185307179586,
                     cap = detail::to_double(with.frequency_cap), usual = detail::to_double(s.step_lengths.usual),
                     count = hertz * usual / detail::to_double(with.contact_frequency_ratio);
        if ((cap > 0 && hertz > cap) || !(count < 1e9)) return 0;
        const int below = static_cast<int>(count);
        return below < 1 ? 1 : count - below > 1e-9 ? below + 1 : below;
    });
}

PHYSICS_HPP_END
