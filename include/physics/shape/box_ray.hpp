// Which boxes a line segment meets.
#pragma once

#include "physics/space/aabb.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A line segment that searches for boxes: no answer leaves out what it meets, some include what it passes by less than
/// rounding.
template <int D>
class box_ray {
public:
    /// From `origin` along `displacement`; `reach` is what boxes are to be grown by.
    box_ray(const vec<double, D>& origin, const vec<double, D>& displacement, double reach)
        : origin_(origin), displacement_(displacement) {
        // The coordinates may be off by as much already.
        reach_ = reach + 0x1p-46 * (largest(origin) + largest(displacement));
        for (int i = 0; i < D; ++i) {
            crosses_[i] = abs(displacement[i]) > 1e-250;
            inverse_[i] = crosses_[i] ? 1 / displacement[i] : 0;
        }
    }
    /// Whether it may meet the box before it has made more than the part `maximum` of its way.
    template <class R>
    [[nodiscard]] bool meets(const aabb<R, D>& box, double maximum) const {
        double near = 0, far = maximum;
        for (int i = 0; i < D; ++i) {
            const double lower = static_cast<double>(box.lower[i]) - reach_ - origin_[i];
            const double upper = static_cast<double>(box.upper[i]) + reach_ - origin_[i];
            if (crosses_[i]) {
                const double a = lower * inverse_[i], b = upper * inverse_[i];
                near = max(near, min(a, b));
                far = min(far, max(a, b));
            } else if (lower > abs(displacement_[i]) || upper < -abs(displacement_[i])) {
                return false;
            }
        }
        // Each of them is known to three roundings.
        return near <= far * (1 + 0x1p-49);
    }
    /// The box around all of it.
    [[nodiscard]] aabb<double, D> bounds() const { return box_of_part(0, 1); }
    /// The box around what is between two coordinates along an axis; false if nothing is.
    [[nodiscard]] bool bounds_between(int axis, double low, double high, aabb<double, D>& box) const {
        double near = 0, far = 1;
        if (crosses_[axis]) {
            const double a = (low - reach_ - origin_[axis]) * inverse_[axis];
            const double b = (high + reach_ - origin_[axis]) * inverse_[axis];
            near = max(near, min(a, b) * (1 - 0x1p-50));
            far = min(far, max(a, b) * (1 + 0x1p-50));
        }
        box = box_of_part(near, far);
        return near <= far;
    }

private:
    aabb<double, D> box_of_part(double near, double far) const {
        const vec<double, D> a = origin_ + displacement_ * near, b = origin_ + displacement_ * far;
        return grown(aabb<double, D>{min(a, b), max(a, b)}, reach_);
    }

    vec<double, D> origin_, displacement_, inverse_;
    double reach_;
    bool crosses_[D];
};

}  // namespace detail

PHYSICS_HPP_END
