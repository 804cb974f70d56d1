// Snapshots of a world's state: all that lasts from step to step, in one block of memory.
#pragma once

#include "physics/base/members.hpp"
#include "physics/world/check.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// One of the owners of some blocks of geometry.
class geometry_keeper {
public:
    geometry_keeper() = default;
    geometry_keeper(const geometry_keeper& other) : blocks_(other.blocks_) { each(retain); }
    geometry_keeper(geometry_keeper&&) noexcept = default;
    geometry_keeper& operator=(const geometry_keeper& other) {
        if (this == &other) return *this;
        // What may fail comes first.
        blocks_.reserve(other.blocks_.size());
        other.each(retain);
        each(release);
        blocks_ = other.blocks_;
        return *this;
    }
    geometry_keeper& operator=(geometry_keeper&& other) noexcept {
        geometry_keeper taken(std::move(other));
        blocks_.swap(taken.blocks_);
        return *this;
    }
    ~geometry_keeper() { each(release); }

    /// Makes room for what these shapes refer to.
    template <class Shapes>
    void reserve(const Shapes& shapes) {
        std::uint32_t count = 0;
        shapes.each_geometry([&](const geometry_block* block) { count += block != nullptr; });
        blocks_.reserve(count);
    }
    /// Keeps that instead.
    template <class Shapes>
    void keep(const Shapes& shapes) {
        // First, so that what stays has an owner all the while.
        shapes.each_geometry(retain);
        each(release);
        blocks_.clear();
        shapes.each_geometry([&](const geometry_block* block) {
            if (block != nullptr) blocks_.push_back(block);
        });
    }

private:
    void each(void (*change)(const geometry_block*)) const {
        for (const geometry_block* block : blocks_) change(block);
    }

    buffer<const geometry_block*> blocks_;
};

/// Says in one sentence why there can be no snapshot of a world.
template <class Plan>
struct snapshot_audit {
    static constexpr bool has_members = names_members<typename Plan::broadphase>;
    static constexpr bool is_plain = std::is_trivially_copyable_v<typename Plan::settings>;
    static_assert(
        has_members,
        "physics::recipe: no snapshot of the world can be made, as the broadphase does not name what lasts of "
        "it; its in<Space> needs a static each_member(self, f)");
    static_assert(is_plain,
                  "physics::recipe: no snapshot of the world can be made, as the solver's settings are not trivially "
                  "copyable");
};

/// What lasts of a world from step to step, copied piece by piece into one block that holds no address of its own
/// memory: of buffers how many values they have, and these; what lies behind them for growth stays out, and so does
/// scratch. Written over a world of the same recipe, of whatever history, it brings back the state with its numbers,
/// generations and settings: the steps that follow have the same bits. The world keeps its tag, so that those handles
/// serve it that did before. Shapes share their geometry with the snapshot, which is one of its owners.
/// For the process that made it: no format to store. Cost: that of copying the bytes, and some ns for each shape with
/// geometry.
template <class Plan>
class raw_snapshot {
    using audit = snapshot_audit<Plan>;
    static_assert(sizeof(audit) > 0);

public:
    /// Makes this the snapshot of a world as it is now. Takes memory only where the snapshot has not been so large
    /// before.
    void save(const state<Plan>& s) {
        std::uint64_t units = 0;
        each_piece(s, [&](const auto& piece) { units += units_of(piece); });
        if (units > 0xffffffffu) {
            // As for buffers: there is no such memory.
            refuse("snapshot", "memory", static_cast<double>(units) * sizeof(unit), "the bytes are not available");
            std::abort();
        }
        // What may fail comes first.
        units_.reserve(static_cast<std::uint32_t>(units));
        geometry_.reserve(s.shapes);
        units_.clear();
        each_piece(s, [&](const auto& piece) { write(piece); });
        geometry_.keep(s.shapes);
    }

    /// Brings a world to the state that was saved. Takes memory only where the world has not had so much before.
    /// Refused, with nothing changed, if nothing was saved or a step of the world is under way.
    bool restore(world_data<Plan>& s) const {
        if (units_.empty()) return refuse("restore", "snapshot", "empty", "it must have been saved");
        if (!check_not_in_step(s, "restore")) return false;
        // What may fail comes first.
        const unit* from = units_.begin();
        each_piece<state<Plan>>(s, [&](auto& piece) { from = make_room(piece, from); });
        s.shapes.each_geometry(release);
        from = units_.begin();
        each_piece<state<Plan>>(s, [&](auto& piece) { from = read(piece, from); });
        s.shapes.each_geometry(retain);
        s.step.forget();
        return true;
    }

    /// The block, and its bytes.
    [[nodiscard]] const void* data() const { return units_.begin(); }
    [[nodiscard]] std::size_t size() const { return std::size_t{units_.size()} * sizeof(unit); }

private:
    /// Pieces begin at multiples of it, and so do numbers of values and these.
    struct alignas(16) unit {
        unsigned char bytes[16];
    };
    static constexpr std::uint32_t units_for(std::size_t bytes) {
        return static_cast<std::uint32_t>((bytes + sizeof(unit) - 1) / sizeof(unit));
    }
    template <class T>
    static std::uint64_t units_of(const T&) {
        return units_for(sizeof(T));
    }
    template <class T>
    static std::uint64_t units_of(const buffer<T>& piece) {
        return std::uint64_t{1} + units_for(std::size_t{piece.size()} * sizeof(T));
    }

    /// Nothing of what was refused above, so that nothing else is said of it.
    template <class State, class F>
    static void each_piece(State& s, F&& f) {
        if constexpr (audit::has_members && audit::is_plain) each_value_of(s, f);
    }
    void write(const void* from, std::size_t bytes) {
        if (bytes == 0) return;
        unit* const to = units_.extend(units_for(bytes));
        // What is behind the last byte.
        units_.back() = {};
        std::memcpy(to, from, bytes);
    }
    template <class T>
    void write(const T& piece) {
        write(&piece, sizeof(T));
    }
    template <class T>
    void write(const buffer<T>& piece) {
        write(piece.size());
        write(piece.begin(), std::size_t{piece.size()} * sizeof(T));
    }
    static const unit* read(void* to, std::size_t bytes, const unit* from) {
        if (bytes > 0) std::memcpy(to, from, bytes);
        return from + units_for(bytes);
    }
    template <class T>
    static const unit* read(T& piece, const unit* from) {
        return read(&piece, sizeof(T), from);
    }
    template <class T>
    static const unit* read(buffer<T>& piece, const unit* from) {
        std::uint32_t count = 0;
        from = read(count, from);
        piece.clear();
        return read(piece.extend(count), std::size_t{count} * sizeof(T), from);
    }
    template <class T>
    static const unit* make_room(T&, const unit* from) {
        return from + units_for(sizeof(T));
    }
    template <class T>
    static const unit* make_room(buffer<T>& piece, const unit* from) {
        std::uint32_t count = 0;
        from = read(count, from);
        piece.reserve(count);
        return from + units_for(std::size_t{count} * sizeof(T));
    }

    buffer<unit> units_;
    geometry_keeper geometry_;
};

}  // namespace detail

PHYSICS_HPP_END
