// What a loop over a world's bodies and contacts walks along.
#pragma once

#include "physics/base/small_buffer.hpp"
#include "physics/base/sort.hpp"
#include "physics/step/state.hpp"
#include "physics/step/touching.hpp"
#include "physics/world/settings.hpp"
#include "physics/world/world_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where a loop ends.
struct range_end {};

/// The bodies of a world, in the order of their numbers. A loop may change the world: it leaves out what has been
/// destroyed, and goes no farther than the numbers that there were when it began.
template <class Plan>
class body_range {
public:
    explicit body_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        explicit iterator(const state<Plan>& s) : state_(&s), end_(s.bodies.slots()), at_(s.bodies.next(0)) {}
        body_id operator*() const { return {at_, state_->bodies.generation(at_), state_->tag}; }
        iterator& operator++() {
            at_ = state_->bodies.next(at_ + 1);
            return *this;
        }
        bool operator==(range_end) const { return at_ >= end_ || at_ >= state_->bodies.slots(); }

    private:
        const state<Plan>* state_;
        std::uint32_t end_, at_;
    };
    iterator begin() const { return iterator(*state_); }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
};

/// The shapes of one body, in descending order of their numbers. A loop may change the world: it leaves out what has
/// been destroyed.
template <class Plan>
class shape_range {
public:
    shape_range(const state<Plan>& s, body_id body) : state_(&s), body_(body) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, body_id body) : state_(&s), body_(body) { go_below(no_shape); }
        shape_id operator*() const { return {at_, state_->shapes.generation(at_), state_->tag}; }
        iterator& operator++() {
            if (!state_->shapes.alive(at_) || state_->shapes[at_].body != body_.index || !has_body()) go_below(at_);
            else at_ = state_->shapes[at_].next;
            return *this;
        }
        bool operator==(range_end) const { return at_ == no_shape; }

    private:
        [[nodiscard]] bool has_body() const { return state_->bodies.contains(body_.index, body_.generation); }
        /// To the first shape below a number.
        void go_below(std::uint32_t number) {
            at_ = has_body() ? state_->bodies[body_.index].first_shape : no_shape;
            while (at_ != no_shape && at_ >= number) at_ = state_->shapes[at_].next;
        }

        const state<Plan>* state_;
        body_id body_;
        std::uint32_t at_ = no_shape;
    };
    iterator begin() const { return {*state_, body_}; }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
    body_id body_;
};

/// Whether the shapes of a contact touch; see contact_view.
template <class Plan>
bool is_touching(const state<Plan>& s, const typename Plan::contact& c) {
    if constexpr (Plan::events::contacts) {
        return c.touching;
    } else {
        if (pressed_points(c) != 0) return true;
        const auto displacement = [&](std::uint32_t body, const auto& from) {
            const auto& b = s.bodies[body];
            const auto& start = s.contact_starts[body];
            return b.center - start.position + (b.rotation * inverse_rotate(start.rotation, from) - from);
        };
        for (int k = 0; k < c.count; ++k) {
            const auto [a, b] = c.anchors(k);
            const auto apart = displacement(c.bodies.body_b, b) - displacement(c.bodies.body_a, a);
            if (c.points[k].separation + dot(c.normal, apart) <=
                s.settings.contact_margin * typename Plan::scalar(touch_margin))
                return true;
        }
        return false;
    }
}

template <class Plan>
auto view_of(const state<Plan>& s, const typename Plan::contact& c) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const std::uint32_t at_a = c.bodies.body_a, at_b = c.bodies.body_b;
    const auto& a = s.bodies[at_a];
    const auto& b = s.bodies[at_b];
    contact_view<S, D> view{{c.shape_a, s.shapes.generation(c.shape_a), s.tag},
                            {c.shape_b, s.shapes.generation(c.shape_b), s.tag},
                            {at_a, s.bodies.generation(at_a), s.tag},
                            {at_b, s.bodies.generation(at_b), s.tag},
                            c.part,
                            is_touching(s, c),
                            c.normal,
                            tangents<S, D>(c.normal),
                            {},
                            c.count,
                            s.surfaces.friction_of(c),
                            s.surfaces.restitution_of(c),
                            s.surfaces.rolling_resistance_of(c),
                            c.surface_velocity,
                            c.twist_impulse,
                            c.rolling_impulse};
    for (int k = 0; k < c.count; ++k) {
        const auto& p = c.points[k];
        const auto [to_a, to_b] = c.anchors(k);
        const vec<S, D> local_a = inverse_rotate(s.contact_starts[at_a].rotation, to_a) + a.mass.center;
        const vec<S, D> local_b = inverse_rotate(s.contact_starts[at_b].rotation, to_b) + b.mass.center;
        view.points[k] = {a.pose() * local_a, local_a,       local_b, p.separation, p.normal_impulse,
                          p.friction_impulse, c.persisted(k)};
    }
    return view;
}

/// What is seen of a contact that is gone.
template <class S, int D>
contact_view<S, D> no_contact() {
    vec<S, D> any;
    any[0] = S(1);
    return {{}, {}, {}, {}, 0, false, any, tangents<S, D>(any), {}, 0, {}, {}, {}, {}, {}, {}};
}

/// The first contact in a list that is not before a pair.
template <class Contact>
std::uint32_t first_contact(const buffer<Contact>& in, proxy_pair pair) {
    return count_before(in, [&](const Contact& c) { return c.key() < pair; });
}

/// The contacts of a world's last step, in ascending order of their shapes' numbers; those of sleepers as they were
/// when they fell asleep. A loop may change the world: each contact that lasts comes once, and none that is gone.
template <class Plan>
class contact_range {
    using list = buffer<typename Plan::contact>;

public:
    explicit contact_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        explicit iterator(const state<Plan>& s) : state_(&s) { find(); }
        /// One without shapes, bodies and points if the contact is gone.
        auto operator*() const {
            iterator here = *this;
            here.find();
            const bool lasts = !here.at_end_ && here.pair_ == pair_ && here.rank_ == rank_;
            if (lasts) return view_of(*state_, lists()[here.list_][here.first_[here.list_] + rank_]);
            return no_contact<typename Plan::scalar, Plan::dimension>();
        }
        iterator& operator++() {
            ++rank_;
            find();
            return *this;
        }
        bool operator==(range_end) const { return at_end_; }

    private:
        struct both {
            const list &awake, &asleep;
            const list& operator[](int k) const { return k == 0 ? awake : asleep; }
        };
        [[nodiscard]] both lists() const {
            if constexpr (Plan::sleeps) return {state_->contacts, state_->sleep.contacts};
            else return {state_->contacts, state_->contacts};
        }
        static constexpr int count = Plan::sleeps ? 2 : 1;

        /// The contact of this rank of the pair, or else the first one of the first pair behind. A pair's contacts are
        /// side by side in one of the lists; to wake or to fall asleep takes them to the other.
        void find() {
            at_end_ = false;
            for (list_ = 0; list_ < count; ++list_) {
                const list& in = lists()[list_];
                first_[list_] = first_from(in, first_[list_]);
                const std::uint32_t at = first_[list_] + rank_;
                if (at < in.size() && in[at].key() == pair_ && !state_->removed.in(in[at])) return;
            }
            proxy_pair next = pair_;
            at_end_ = true;
            for (int k = 0; k < count; ++k) {
                const list& in = lists()[k];
                while (first_[k] < in.size() && (in[first_[k]].key() == pair_ || state_->removed.in(in[first_[k]])))
                    ++first_[k];
                if (first_[k] == in.size() || (!at_end_ && !(in[first_[k]].key() < next))) continue;
                next = in[first_[k]].key();
                list_ = k;
                at_end_ = false;
            }
            pair_ = next;
            rank_ = 0;
        }
        /// The first contact in a list that is not before the pair; most often where it was.
        [[nodiscard]] std::uint32_t first_from(const list& in, std::uint32_t guess) const {
            if (guess <= in.size() && (guess == 0 || in[guess - 1].key() < pair_) &&
                (guess == in.size() || !(in[guess].key() < pair_)))
                return guess;
            return first_contact(in, pair_);
        }

        const state<Plan>* state_;
        proxy_pair pair_{};
        std::uint32_t rank_ = 0;
        /// In each list, the first contact that is not before the pair.
        std::uint32_t first_[2] = {};
        int list_ = 0;
        bool at_end_ = false;
    };
    iterator begin() const { return iterator(*state_); }
    range_end end() const { return {}; }
    /// Number of contacts. O(contacts) after some have been destroyed, until the next step.
    [[nodiscard]] std::uint32_t size() const {
        const auto size_of = [&](const list& in) {
            std::uint32_t count = in.size();
            if (state_->removed.any())
                for (const auto& c : in) count -= state_->removed.in(c);
            return count;
        };
        if constexpr (Plan::sleeps) return size_of(state_->contacts) + size_of(state_->sleep.contacts);
        else return size_of(state_->contacts);
    }

private:
    const state<Plan>* state_;
};

/// The contacts of one body or shape, in ascending order of their shapes' numbers. A loop may change the world: what is
/// gone comes as no_contact.
template <class Plan>
class own_contact_range {
    /// Which one of a pair's contacts it is, and where it was in its list.
    struct place {
        proxy_pair pair;
        std::uint32_t rank, at;
    };

public:
    /// Of a body, and of one of its shapes only unless that is no_shape.
    own_contact_range(const world_data<Plan>& s, std::uint32_t body, std::uint32_t shape) : state_(&s) {
        each_contact(s, body, [&](const auto& in, std::uint32_t at) {
            if (shape != no_shape && in[at].shape_a != shape && in[at].shape_b != shape) return;
            std::uint32_t rank = 0;
            while (rank < at && in[at - rank - 1].key() == in[at].key()) ++rank;
            places_.push_back({in[at].key(), rank, at});
        });
        sort_in_place(places_.begin(), places_.size(), [](const place& x, const place& y) {
            return x.pair == y.pair ? x.rank < y.rank : x.pair < y.pair;
        });
    }
    explicit own_contact_range(const world_data<Plan>& s) : state_(&s) {}

    class iterator {
    public:
        iterator(const state<Plan>& s, const place* at) : state_(&s), at_(at) {}
        auto operator*() const {
            if (const auto* c = find(state_->contacts)) return view_of(*state_, *c);
            if constexpr (Plan::sleeps)
                if (const auto* c = find(state_->sleep.contacts)) return view_of(*state_, *c);
            return no_contact<typename Plan::scalar, Plan::dimension>();
        }
        iterator& operator++() {
            ++at_;
            return *this;
        }
        friend bool operator==(const iterator&, const iterator&) = default;

    private:
        const typename Plan::contact* find(const buffer<typename Plan::contact>& in) const {
            const auto is_here = [&](std::uint32_t i) {
                return i < in.size() && in[i].key() == at_->pair && !state_->removed.in(in[i]);
            };
            const std::uint32_t first = at_->at - at_->rank;
            if (is_here(at_->at) && is_here(first) && (first == 0 || !is_here(first - 1))) return &in[at_->at];
            const std::uint32_t i = first_contact(in, at_->pair) + at_->rank;
            return is_here(i) ? &in[i] : nullptr;
        }

        const state<Plan>* state_;
        const place* at_;
    };
    [[nodiscard]] iterator begin() const { return {*state_, places_.begin()}; }
    [[nodiscard]] iterator end() const { return {*state_, places_.end()}; }
    /// Number of contacts.
    [[nodiscard]] std::uint32_t size() const { return places_.size(); }

private:
    const state<Plan>* state_;
    small_buffer<place, 16> places_;
};

}  // namespace detail

PHYSICS_HPP_END
