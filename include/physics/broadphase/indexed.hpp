// A broadphase made of an index of boxes: what all that the library ships have in common.
#pragma once

#include "physics/base/members.hpp"
#include "physics/broadphase/guard.hpp"
#include "physics/broadphase/pair_set.hpp"
#include "physics/broadphase/queries.hpp"

PHYSICS_HPP_BEGIN

/// A broadphase: boxes by number, with margins, filters and what persists of their pairs; queries with exact answers,
/// the same whatever the index, in which boxes have their margins. Only speed depends on the index, and its class
/// says what it costs. Numbers are small and may come again after erase. Functions that change anything refuse to do
/// so from within a visitor, where the query has not ended.
/// An index has, each with the table of proxies first (`all.box(id)`, `all.has(id)`, ...):
///   insert(all, id), erase(all, id)   at once; erase is called while the table still knows the proxy
///   update(all, ids, count)           these have another box than before
///   find(all, emit)                   emit(a, b) once for each two proxies, one of which is all.stale(), whose boxes
///                                     may overlap; true if those were all pairs there are. An index with
///                                     `static constexpr bool exact = true` emits just those that do overlap and that
///                                     all.may_meet(a, b)
///   each_near(all, box, visit)        visit(id) where the box may overlap, until it returns false; or, of an index
///                                     that keeps them itself, visit(candidate) with filter and box
///   end_search()                      where it has this: what find emitted has been taken in
///   reserve(all, slots, changes)      where it has this: takes the memory for so many changes of proxies of numbers
///                                     below `slots`, and the update after them. An index without it that finds no
///                                     memory is made anew by the next update, and queries look at all boxes until then
/// and, where it knows a better way than to search boxes, each_along, each_around, each_inside (see tree_index),
/// each_near(all, box, visit, movable), which leaves out what moves if false, and each_member(self, f), for snapshots
/// of worlds (see base/members.hpp).
template <class Space, class Index>
class indexed_broadphase {
public:
    using S = typename Space::scalar;
    using vec = typename Space::vec;
    using aabb = typename Space::aabb;
    static constexpr int D = Space::dimension;

    /// From now on; boxes stay as they are until they are left.
    void configure(const broadphase_settings<S>& settings) {
        if (check(settings, "configure")) all_.settings = settings;
    }
    [[nodiscard]] std::uint32_t count() const { return all_.count(); }
    /// The box of a proxy, with its margins.
    [[nodiscard]] const aabb& box(std::uint32_t id) const { return all_.box(id); }

    /// Whether a proxy in this box keeps within its margins, so that moving it there changes nothing.
    [[nodiscard]] bool holds(std::uint32_t id, const aabb& box) const { return all_.has(id) && all_.holds(id, box); }

    /// Takes the memory for so many calls of insert, erase and move, of numbers below `slots`, and an update after
    /// them: these find what they need then.
    void reserve(std::uint32_t slots, std::uint32_t changes) {
        if (slots < all_.size()) slots = all_.size();
        all_.reserve(slots);
        if constexpr (reserves) index_.reserve(all_, slots, changes);
    }
    /// Adds a proxy under a number that is free. False where a call was refused and errors do not throw.
    bool insert(std::uint32_t id, const aabb& box, const proxy_filter& filter = {}) {
        const char* f = "insert";
        if (!query_scope_allows(f) || !check_box(f, box)) return false;
        if (id == detail::no_proxy || all_.has(id)) return refuse(f, "id", id, "it must not be in use");
        reserve(id + 1, 1);
        all_.insert(id, box, filter);
        change_index([&] { index_.insert(all_, id); });
        return true;
    }
    bool erase(std::uint32_t id) {
        const char* f = "erase";
        if (!query_scope_allows(f) || !check_id(f, id)) return false;
        all_.reserve(all_.size());
        change_index([&] { index_.erase(all_, id); });
        all_.erase(id);
        return true;
    }
    /// The proxy is in this box now, and on the way (m a step); nothing happens as long as it keeps within its
    /// margins. Queries see it after update() or pairs(). Cost: 3 to 5 ns.
    bool move(std::uint32_t id, const aabb& box, const vec& displacement = {}) {
        const char* f = "move";
        if (!check_id(f, id)) return false;
        if (all_.holds(id, box)) return true;
        if (!query_scope_allows(f) || !check_box(f, box)) return false;
        all_.move(id, box, displacement);
        return true;
    }
    /// Shows what has moved to queries.
    void update() {
        if (!query_scope_allows("update")) return;
        if constexpr (!reserves)
            if (std::exchange(is_broken_, false)) change_index([&] { remake(); });
        change_index([&] { index_.update(all_, all_.dirty_for_index().begin(), all_.dirty_for_index().size()); });
        all_.flush_to_index();
    }

    /// All pairs of proxies that may meet, whose boxes overlap and that accept(a, b) takes, in ascending order. It is
    /// asked when a pair is found, and again when one of the two has left its box.
    template <class Accept>
    const buffer<proxy_pair>& pairs(Accept&& accept) {
        scratch_.reset();
        return pairs(accept, scratch_);
    }
    /// The same with memory of the caller's, which has it back afterwards.
    template <class Accept>
    const buffer<proxy_pair>& pairs(Accept&& accept, arena& scratch) {
        if (!query_scope_allows("pairs")) return pairs_.pairs();
        update();
        if constexpr (!reserves)
            if (is_broken_) remake();
        is_broken_ = false;
        detail::pair_search found(all_.size(), scratch);
        const bool everything = index_.find(all_, [&](std::uint32_t a, std::uint32_t b) {
            if constexpr (!requires { requires Index::exact; })
                if (!all_.may_meet(a, b) || !overlap(all_.box(a), all_.box(b))) return;
            if (accept(a < b ? a : b, a < b ? b : a)) found.add(a, b);
        });
        pairs_.finish(found, all_, everything);
        if constexpr (requires { index_.end_search(); }) index_.end_search();
        all_.clear_dirty();
        return pairs_.pairs();
    }
    /// What the last call of pairs() had and the one before it had not, in ascending order; and the reverse. A number
    /// that was given to another proxy in between ends its pairs and begins them.
    [[nodiscard]] const buffer<proxy_pair>& begun() const { return pairs_.begun(); }
    [[nodiscard]] const buffer<proxy_pair>& ended() const { return pairs_.ended(); }

    /// Calls visit(id) for every proxy whose box shares a point with this one, in any order. Where visit returns a
    /// bool, false ends the query. Unless movable is true, those that are may be left out, to save time.
    template <class Visit>
    void each_overlapping(const aabb& box, const query_filter& filter, Visit&& visit, bool movable = true) const {
        if (!check_box("each_overlapping", box)) return;
        const detail::query_scope scope(this);
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            return !filter.sees(c.filter) || !overlap(c.box, box) || detail::go_on(visit, c.id);
        };
        if (is_lost()) each_proxy(see);
        else if constexpr (requires { index_.each_near(all_, box, see, movable); })
            index_.each_near(all_, box, see, movable);
        else index_.each_near(all_, box, see);
    }
    /// Writes up to `maximum` of them to `out` instead; returns how many there are.
    std::uint32_t overlapping(const aabb& box, const query_filter& filter, std::uint32_t* out,
                              std::uint32_t maximum) const {
        std::uint32_t count = 0;
        each_overlapping(box, filter, [&](std::uint32_t id) {
            if (count < maximum) out[count] = id;
            ++count;
        });
        return count;
    }
    /// The same for a point.
    template <class Visit>
    void each_at(const vec& point, const query_filter& filter, Visit&& visit) const {
        if (detail::check_finite("each_at", "point", point)) each_overlapping({point, point}, filter, visit);
    }
    /// Calls visit(id) for every proxy whose box does not lie wholly beyond one of the planes: boxes in a convex
    /// region, and a few beside its edges.
    template <class Visit>
    void each_inside(const bounding_plane<S, D>* planes, std::uint32_t count, const query_filter& filter,
                     Visit&& visit) const {
        for (std::uint32_t i = 0; i < count; ++i)
            if (!detail::check_finite("each_inside", "normal", planes[i].normal) ||
                !detail::check_finite("each_inside", "offset", planes[i].offset))
                return;
        const detail::query_scope scope(this);
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            if (!filter.sees(c.filter)) return true;
            for (std::uint32_t i = 0; i < count; ++i)
                if (detail::beyond(planes[i], c.box)) return true;
            return detail::go_on(visit, c.id);
        };
        if (is_lost()) each_proxy(see);
        else if constexpr (requires { index_.each_inside(all_, planes, count, see); })
            index_.each_inside(all_, planes, count, see);
        else index_.each_near(all_, everywhere(), see);
    }
    template <array_of<bounding_plane<S, D>> Planes, class Visit>
    void each_inside(const Planes& planes, const query_filter& filter, Visit&& visit) const {
        if (detail::check_count("each_inside", "planes", planes))
            each_inside(planes.data(), detail::count_of(planes), filter, visit);
    }
    /// Calls visit(hit) for proxies whose boxes the ray meets, the first ones early. visit returns the fraction of the
    /// translation up to which the ray goes on: hit.fraction for the closest, 1 for all, -1 to stop.
    template <class Visit>
    void each_along(const ray<S, D>& r, const query_filter& filter, Visit&& visit) const {
        if (!check_ray("each_along", r)) return;
        const detail::query_scope scope(this);
        S limit = S(1);
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            proxy_hit<S> hit{c.id};
            if (limit >= S(0) && filter.sees(c.filter) && detail::meets(r, c.box, limit, hit.fraction))
                limit = min(limit, visit(hit));
            return limit;
        };
        if (is_lost()) {
            each_proxy([&](std::uint32_t id) { return see(id) >= S(0); });
        } else if constexpr (requires { index_.each_along(all_, r, limit, see); }) {
            index_.each_along(all_, r, limit, see);
        } else {
            index_.each_near(all_, detail::around(r), [&](const auto& at) { return see(at) >= S(0); });
        }
    }
    /// The first proxy on the ray, that of the least number among equals; one with no proxy where there is none.
    [[nodiscard]] proxy_hit<S> closest(const ray<S, D>& r, const query_filter& filter = {}) const {
        proxy_hit<S> best;
        each_along(r, filter, [&](const proxy_hit<S>& hit) {
            if (hit.fraction < best.fraction || (hit.fraction == best.fraction && hit.id < best.id)) best = hit;
            return best.fraction;
        });
        return best;
    }
    /// Writes up to `maximum` hits to `out`, the first ones, in order; of equal fractions that of the least number
    /// first. Returns how many.
    std::uint32_t along(const ray<S, D>& r, const query_filter& filter, proxy_hit<S>* out,
                        std::uint32_t maximum) const {
        std::uint32_t count = 0;
        each_along(r, filter, [&](const proxy_hit<S>& hit) {
            const auto after = [&](const proxy_hit<S>& other) {
                return other.fraction > hit.fraction || (other.fraction == hit.fraction && other.id > hit.id);
            };
            detail::insert_sorted(out, count, maximum, hit, after);
            return count < maximum ? S(1) : maximum == 0 ? S(-1) : out[maximum - 1].fraction;
        });
        return count;
    }
    /// Whether there is any. Stops at the first found.
    [[nodiscard]] bool any(const ray<S, D>& r, const query_filter& filter = {}) const {
        bool found = false;
        each_along(r, filter, [&](const proxy_hit<S>&) {
            found = true;
            return S(-1);
        });
        return found;
    }
    /// Writes up to `maximum` proxies to `out`, the nearest to the point first, of equals that of the least number,
    /// none farther than `reach`; returns how many.
    std::uint32_t nearest(const vec& point, S reach, const query_filter& filter, std::uint32_t* out,
                          std::uint32_t maximum) const {
        const char* f = "nearest";
        if (!detail::check_finite(f, "point", point) || !detail::check_not_negative(f, "reach", reach) || maximum == 0)
            return 0;
        const detail::query_scope scope(this);
        std::uint32_t count = 0;
        const wide_of<S> farthest = product(reach, reach);
        const auto square = [&](std::uint32_t id) { return detail::distance_squared(all_.box(id), point); };
        const auto see = [&](const auto& at) {
            const auto& c = all_.candidate_at(at);
            const std::uint32_t id = c.id;
            const wide_of<S> here = detail::distance_squared(c.box, point);
            if (filter.sees(c.filter) && !(here > farthest)) {
                const auto after = [&](std::uint32_t other) {
                    return square(other) > here || (square(other) == here && other > id);
                };
                detail::insert_sorted(out, count, maximum, id, after);
            }
            return count < maximum ? farthest : square(out[count - 1]);
        };
        const auto see_all = [&](const auto& at) {
            see(at);
            return true;
        };
        if (is_lost()) each_proxy(see_all);
        else if constexpr (requires { index_.each_around(all_, point, farthest, see); })
            index_.each_around(all_, point, farthest, see);
        else index_.each_near(all_, everywhere(), see_all);
        return count;
    }

    /// Calls f(box) for the boxes of what the index is made of, in double, where it has such: to draw them.
    template <class F>
    void each_node(F&& f) const requires requires(const Index& i) {
        i.each_node(f);
    }
    { index_.each_node(f); }

    /// All members, see base/members.hpp: of an index that names its own, or has none.
    template <class Self, class F>
        requires(detail::names_members<Index> || std::is_empty_v<Index>)
    static void each_member(Self& self, F&& f) {
        auto& [all, index, pairs, is_broken, scratch] = self;
        detail::call_with_each(f, all, index, pairs, is_broken, scratch);
    }

private:
    bool query_scope_allows(const char* function) const { return detail::query_scope::allows_change(this, function); }
    bool check_id(const char* function, std::uint32_t id) const {
        return all_.has(id) || refuse(function, "id", id, "it must have been inserted");
    }
    static bool check_box(const char* function, const aabb& box) {
        if (!detail::check_finite(function, "lower", box.lower) || !detail::check_finite(function, "upper", box.upper))
            return false;
        for (int i = 0; i < D; ++i) {
            const char component[] = {'.', "xyz"[i], '\0'};
            if (box.lower[i] > box.upper[i])
                return detail::refuse(function, "lower", component, static_cast<double>(box.lower[i]),
                                      "it must not be greater than upper");
        }
        return true;
    }
    static bool check_ray(const char* function, const ray<S, D>& r) {
        if (!detail::check_finite(function, "origin", r.origin) ||
            !detail::check_finite(function, "translation", r.translation))
            return false;
        for (int i = 0; i < D; ++i) {
            if (!detail::check_not_negative(function, "extent", r.extent[i])) return false;
            const S end = r.origin[i] + r.translation[i];
            // In fixed point a sum beyond the range comes out on the other side; in floats a small one changes nothing.
            const bool wrapped = r.translation[i] > S(0) ? end < r.origin[i] : end > r.origin[i];
            if (!is_finite(end) || wrapped)
                return detail::refuse(function, "translation", static_cast<double>(r.translation[i]),
                                      "it must end within the scalar's range");
        }
        return true;
    }
    static aabb everywhere() {
        const vec far = vec::filled(scalar_traits<S>::max());
        return {-far, far};
    }
    /// Whether the index tells of the memory that it needs.
    static constexpr bool reserves = requires(Index & i, const detail::proxies<Space>& all) { i.reserve(all, 0u, 0u); };
    /// An index that finds no memory is made anew by the next update, from the proxies.
    template <class F>
    void change_index(F&& f) {
        if constexpr (reserves) {
            f();
        } else if (!is_broken_) {
            is_broken_ = true;
            if (detail::run_if_memory_lasts(f)) is_broken_ = false;
        }
    }
    void remake() {
        index_ = Index();
        // One by one: an index may look at all that are there when one comes.
        detail::proxies<Space> came;
        came.settings.margin = S(0);
        for (std::uint32_t id = 0; id < all_.size(); ++id) {
            if (!all_.has(id)) continue;
            came.insert(id, all_.box(id), all_.filter(id));
            index_.insert(came, id);
        }
        index_.update(all_, nullptr, 0);
    }
    /// Whether queries have to do without the index.
    [[nodiscard]] bool is_lost() const {
        if constexpr (reserves) return false;
        else return is_broken_;
    }
    template <class See>
    void each_proxy([[maybe_unused]] See&& see) const {
        if constexpr (!reserves)
            for (std::uint32_t id = 0; id < all_.size(); ++id)
                if (all_.has(id) && !see(id)) return;
    }

    detail::proxies<Space> all_;
    Index index_;
    detail::pair_set pairs_;
    bool is_broken_ = false;
    arena scratch_;
};

PHYSICS_HPP_END
