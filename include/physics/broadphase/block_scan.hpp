// Queries that indices of blocks of boxes have in common.
#pragma once

#include "physics/broadphase/box_tests.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Queries for an index whose boxes lie in blocks:
///   each_eight(f)        f(block, id_of) for each, where id_of(lane) is a proxy, until it returns false
///   each_eight(box, f)   the same for those with boxes that may meet a box
///   each_loose(visit)    visit(id) for what is in no block
///   usual_size()         how far to look for neighbours at first
/// Costs: each_inside 0.3 to 0.5 ns a proxy, wherever it is.
template <class Index, class Space>
class block_scan {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;

    template <class Table, class Visit>
    void each_inside(const Table&, const bounding_plane<S, D>* planes, std::uint32_t count, Visit&& visit) const {
        const float_region<D> region(planes, count, self().origin());
        bool on = true;
        self().each_loose([&](std::uint32_t id) { on = on && visit(id); });
        self().each_eight([&](const box_block<D>& block, auto&& id_of) {
            each_bit(region.reaches(block), [&](std::uint32_t lane) { on = on && visit(id_of(lane)); });
            return on;
        });
    }
    /// In boxes around the point, each twice as wide as the one before; the rest at once.
    template <class Table, class Visit>
    void each_around(const Table&, const typename Space::vec& point, wide_of<S> limit, Visit&& visit) const {
        const float_point<D> at(point, self().origin());
        float reach = above_square<S>(limit), squares[8], done = -1;
        const auto see = [&](std::uint32_t id) { reach = above_square<S>(visit(id)); };
        const auto scan = [&](float maximum, const box_block<D>& block, auto&& id_of) {
            each_bit(at.within(block, min(maximum, reach), squares), [&](std::uint32_t lane) {
                if (squares[lane] > done && !(squares[lane] > reach)) see(id_of(lane));
            });
            return true;
        };
        self().each_loose(see);
        float radius = self().usual_size();
        for (int round = 0; round < 6 && done < reach; ++round, radius *= 2) {
            float_box<D> near;
            for (int i = 0; i < D; ++i) {
                near.lower[i] = at.lower[i] - radius * 1.00001f;
                near.upper[i] = at.upper[i] + radius * 1.00001f;
            }
            const float maximum = radius * radius;
            self().each_eight(near, [&](const auto& block, auto&& id_of) { return scan(maximum, block, id_of); });
            done = maximum;
        }
        if (done < reach) self().each_eight([&](const auto& block, auto&& id_of) { return scan(reach, block, id_of); });
    }

private:
    const Index& self() const { return static_cast<const Index&>(*this); }
};

}  // namespace detail

PHYSICS_HPP_END
