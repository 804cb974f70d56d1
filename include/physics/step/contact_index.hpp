// The contacts of each body.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/dynamics/edge.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The contacts of each body: numbers in the list of those that can be pushed, and behind its end in that of sleepers.
/// Follows from both lists, and is made when it is first asked for after they have changed. O(bodies + contacts).
struct contact_index {
    bool is_stale = true;

    contact_index() = default;
    contact_index(const contact_index&) {}
    contact_index(contact_index&&) noexcept = default;
    contact_index& operator=(const contact_index&) = delete;
    contact_index& operator=(contact_index&&) noexcept = default;
    ~contact_index() = default;

    /// Calls f(number) for those of a body, in ascending order, after an update.
    template <class F>
    void each(std::uint32_t body, F&& f) const {
        // Bodies that have come since then have none.
        if (body + 1 >= first_.size()) return;
        for (std::uint32_t k = first_[body]; k < first_[body + 1]; ++k) f(numbers_[k]);
    }

    /// Several threads may ask for it at once.
    template <class Contact>
    void update(std::uint32_t bodies, const buffer<Contact>& awake, const buffer<Contact>* asleep) {
        const lock one_at_a_time(taken_);
        if (!is_stale) return;
        const auto each_end = [&](auto&& f) {
            std::uint32_t n = 0;
            for (const buffer<Contact>* list : {&awake, asleep})
                if (list != nullptr)
                    for (const Contact& c : *list) {
                        f(c.bodies.body_a, n);
                        f(c.bodies.body_b, n);
                        ++n;
                    }
        };
        first_.clear();
        first_.resize(bodies + 2);
        numbers_.resize(2 * (awake.size() + (asleep != nullptr ? asleep->size() : 0)));
        // Counts, their sums, and then each body's place, which moves to the next one's.
        each_end([&](std::uint32_t body, std::uint32_t) { ++first_[body + 2]; });
        for (std::uint32_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
        each_end([&](std::uint32_t body, std::uint32_t n) { numbers_[first_[body + 1]++] = n; });
        is_stale = false;
    }

private:
    /// One thread at a time. Where the compiler has no such functions, worlds are asked by one thread only.
    class lock {
    public:
        explicit lock(bool& taken) : taken_(taken) {
#if defined(__GNUC__)
            while (__atomic_test_and_set(&taken_, __ATOMIC_ACQUIRE)) {
            }
#endif
        }
        lock(const lock&) = delete;
        lock& operator=(const lock&) = delete;
        ~lock() {
#if defined(__GNUC__)
            __atomic_clear(&taken_, __ATOMIC_RELEASE);
#endif
        }

    private:
        bool& taken_;
    };

    buffer<std::uint32_t> first_, numbers_;
    bool taken_ = false;
};

}  // namespace detail

PHYSICS_HPP_END
