// The library's queries as contestants of the narrowphase benchmark.
#pragma once

#include <physics.hpp>

#include <memory>
#include <vector>

#include "scene.hpp"

namespace bench {

/// With a policy other than the default one, for manifolds only.
template <class Policy, class S, int D>
class ours final : public solver {
public:
    [[nodiscard]] bool can(const pair_set& s, task t) const override {
        return s.dimension == D && (t == task::manifold || std::is_same_v<Policy, physics::best_per_pair>);
    }
    [[nodiscard]] bool remembers(task) const override { return true; }
    void load(const pair_set& s) override {
        geometries_.clear();
        const auto hull = [this](const solid& from) { return hull_of(from); };
        if (s.first == "sphere") load_two(s, sphere, hull);
        else if (s.first == "capsule") load_two(s, capsule, box);
        else if (s.first == "box") load_two(s, box, box);
        else load_two(s, hull, hull);
    }
    void run(task t, int frame, bool warm, outcome* out) override { runner_->run(t, frame, warm, out); }

private:
    using transform = physics::transform<S, D>;
    using query = physics::narrowphase_query<S, D, physics::ball, physics::capsule, physics::box, physics::hull>;
    using narrowphase =
        typename Policy::template in<S, D, physics::ball, physics::capsule, physics::box, physics::hull>;
    using any = physics::any_shape<S, D, physics::ball, physics::capsule, physics::box, physics::hull>;

    struct runner {
        virtual ~runner() = default;
        virtual void run(task t, int frame, bool warm, outcome* out) = 0;
    };
    template <class A, class B>
    struct typed final : runner {
        std::vector<A> a;
        std::vector<B> b;
        std::vector<any> any_a, any_b;
        std::vector<transform> poses[pair_set::frames];
        std::vector<query> queries[pair_set::frames];
        physics::manifold_list<S, D> found;
        std::vector<physics::gjk_cache> caches;
        std::vector<typename narrowphase::memory> memories;

        void run(task t, int frame, bool warm, outcome* out) override {
            if (t == task::distance)
                each(
                    frame, warm, [&](auto&... with) { return distance(with...); },
                    [&](std::size_t i, const auto& r) { tell(out[i], r.distance, r.normal); });
            else if (t == task::boolean)
                each(
                    frame, warm, [&](auto&... with) { return overlap(with...); },
                    [&](std::size_t i, bool r) { out[i].distance = r ? -1 : 1; });
            else if (t == task::penetration)
                each(
                    frame, warm, [&](auto&... with) { return separation(with...); },
                    [&](std::size_t i, const auto& r) { tell(out[i], r.distance, r.normal); });
            else touch(frame, warm, out);
        }
        template <class Ask, class Tell>
        void each(int frame, bool warm, Ask&& ask, Tell&& answer) {
            for (std::size_t i = 0; i < poses[frame].size(); ++i)
                answer(i, warm ? ask(a[i], b[i], poses[frame][i], caches[i]) : ask(a[i], b[i], poses[frame][i]));
        }
        void touch(int frame, bool warm, outcome* out) {
            const auto& asked = queries[frame];
            found.clear();
            const auto count = static_cast<std::uint32_t>(asked.size());
            if (warm) narrowphase::collide(asked.data(), count, S(0), memories.data(), found);
            else narrowphase::collide(asked.data(), count, S(0), found);
            for (std::size_t i = 0; i < asked.size(); ++i) out[i] = {.distance = 1};
            for (const auto& [number, part, contact] : found) {
                S least = contact.points[0].separation;
                for (int k = 1; k < contact.count; ++k)
                    if (contact.points[k].separation < least) least = contact.points[k].separation;
                tell(out[number], least, contact.normal);
            }
        }
        static void tell(outcome& out, S distance, const physics::vec<S, D>& normal) {
            out.distance = static_cast<double>(distance);
            for (int k = 0; k < D; ++k) out.normal[k] = static_cast<double>(normal[k]);
        }
    };

    static physics::ball<S, D> sphere(const solid& s) { return {S(s.radius)}; }
    static physics::capsule<S, D> capsule(const solid& s) { return {S(s.half[0]), S(s.radius)}; }
    static physics::box<S, D> box(const solid& s) {
        physics::box<S, D> result;
        for (int k = 0; k < D; ++k) result.half_extents[k] = S(s.half[k]);
        return result;
    }
    physics::hull<S, D> hull_of(const solid& s) {
        std::vector<physics::vec<S, D>> points(s.points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            for (int k = 0; k < D; ++k) points[i][k] = S(s.points[i][k]);
        geometries_.push_back(
            physics::hull_geometry<S, D>::build(points.data(), static_cast<std::uint32_t>(points.size())));
        return geometries_.back().shape();
    }
    template <class MakeA, class MakeB>
    void load_two(const pair_set& s, MakeA&& make_a, MakeB&& make_b) {
        using A = decltype(make_a(s.a(0)));
        using B = decltype(make_b(s.b(0)));
        auto it = std::make_unique<typed<A, B>>();
        for (std::size_t i = 0; i < s.pairs(); ++i) {
            it->a.push_back(make_a(s.a(i)));
            it->b.push_back(make_b(s.b(i)));
            it->any_a.emplace_back(it->a[i]);
            it->any_b.emplace_back(it->b[i]);
        }
        for (int frame = 0; frame < pair_set::frames; ++frame)
            for (std::size_t i = 0; i < s.pairs(); ++i) {
                const pose& p = s.poses[frame][i];
                transform at;
                for (int k = 0; k < D; ++k) at.position[k] = S(p.at[k]);
                if constexpr (D == 2)
                    at.rotation = {S(p.turn[3] * p.turn[3] - p.turn[2] * p.turn[2]), S(2 * p.turn[2] * p.turn[3])};
                else at.rotation = {S(p.turn[0]), S(p.turn[1]), S(p.turn[2]), S(p.turn[3])};
                it->poses[frame].push_back(at);
                const auto number = static_cast<std::uint32_t>(i);
                const bool remembered = narrowphase::remembers(it->any_a[i].kind(), it->any_b[i].kind());
                it->queries[frame].push_back(
                    {&it->any_a[i], &it->any_b[i], at, remembered ? number : query::no_memory});
            }
        it->caches.resize(s.pairs());
        it->memories.resize(s.pairs());
        runner_ = std::move(it);
    }

    std::vector<physics::hull_geometry<S, D>> geometries_;
    std::unique_ptr<runner> runner_;
};

}  // namespace bench
