// Slots with stable numbers: things come and go, handles go stale and know it.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/handle.hpp"

PHYSICS_HPP_BEGIN

/// Items in numbered slots. A freed slot is used again, last freed first, under a new generation; a slot
/// whose generations are used up is retired, so a stale handle can never come alive. The order of slots
/// depends on the calls alone, never on memory. Moving from a pool empties it. Insert, erase, look-up: O(1).
template <class T>
class pool {
public:
    /// What a slot looks like from outside.
    struct place {
        std::uint32_t index;
        std::uint16_t generation;
    };

    pool() = default;
    pool(const pool&) = default;
    pool(pool&& other) noexcept { swap(other); }
    pool& operator=(const pool&) = default;
    pool& operator=(pool&& other) noexcept {
        pool taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~pool() = default;
    void swap(pool& other) noexcept {
        items_.swap(other.items_);
        slots_.swap(other.slots_);
        std::swap(free_, other.free_);
        std::swap(count_, other.count_);
    }

    void reserve(std::uint32_t slots) {
        items_.reserve(slots);
        slots_.reserve(slots);
    }
    /// The slot of what is inserted next.
    [[nodiscard]] std::uint32_t next_index() const { return free_ == none ? items_.size() : free_; }
    place insert(const T& item) {
        std::uint32_t index = free_;
        if (index == none) {
            index = items_.size();
            items_.push_back(item);
            slots_.push_back({occupied, 1});
        } else {
            free_ = slots_[index].next;
            slots_[index].next = occupied;
            items_[index] = item;
        }
        ++count_;
        return {index, slots_[index].generation};
    }
    void erase(std::uint32_t index) {
        slot& s = slots_[index];
        --count_;
        if (s.generation == 0xffff) {
            s.next = retired;
            return;
        }
        ++s.generation;
        s.next = free_;
        free_ = index;
    }
    [[nodiscard]] bool contains(std::uint32_t index, std::uint16_t generation) const {
        return alive(index) && slots_[index].generation == generation;
    }
    [[nodiscard]] bool alive(std::uint32_t index) const {
        return index < slots_.size() && slots_[index].next == occupied;
    }
    [[nodiscard]] std::uint16_t generation(std::uint32_t index) const { return slots_[index].generation; }
    T& operator[](std::uint32_t index) { return items_[index]; }
    const T& operator[](std::uint32_t index) const { return items_[index]; }

    /// Number of items.
    [[nodiscard]] std::uint32_t count() const { return count_; }
    /// Number of slots, free ones included: every index is below it.
    [[nodiscard]] std::uint32_t slots() const { return slots_.size(); }
    /// The first occupied slot from index on, or slots() where there is none.
    [[nodiscard]] std::uint32_t next(std::uint32_t index) const {
        while (index < slots_.size() && slots_[index].next != occupied) ++index;
        return index;
    }
    /// Calls f(index, item) for every item in the order of slots.
    template <class F>
    void each(F&& f) {
        for (std::uint32_t i = next(0); i < slots(); i = next(i + 1)) f(i, items_[i]);
    }
    template <class F>
    void each(F&& f) const {
        for (std::uint32_t i = next(0); i < slots(); i = next(i + 1)) f(i, items_[i]);
    }

    /// What lasts of it, see base/members.hpp.
    PHYSICS_HPP_MEMBERS(items_, slots_, free_, count_)

private:
    static constexpr std::uint32_t none = 0xffffffffu, occupied = 0xfffffffeu, retired = 0xfffffffdu;
    struct slot {
        std::uint32_t next;  // the next free slot, or what the slot is
        std::uint16_t generation;
    };

    buffer<T> items_;
    buffer<slot> slots_;
    std::uint32_t free_ = none;
    std::uint32_t count_ = 0;
};

PHYSICS_HPP_END
