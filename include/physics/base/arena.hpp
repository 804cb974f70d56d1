// Memory for one step: taken piece by piece, given back all at once.
#pragma once

#include <cstddef>

#include "physics/base/buffer.hpp"

PHYSICS_HPP_BEGIN

/// Scratch memory. allocate() costs a few instructions; reset() frees everything and, where the last round did
/// not fit into one block, merges the blocks, so that a steady step allocates nothing. A copy starts empty.
class arena {
public:
    using is_scratch = void;

    arena() = default;
    arena(const arena&) {}
    arena(arena&& other) noexcept { swap(other); }
    arena& operator=(const arena&) { return *this; }
    arena& operator=(arena&& other) noexcept {
        arena taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~arena() {
        for (block& b : blocks_) std::free(b.memory);
    }

    /// Room for count values, not initialised, aligned for T and to at least 16 bytes; valid until reset().
    template <class T>
    T* allocate(std::uint32_t count) {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
        const std::size_t bytes = (std::size_t{count} * sizeof(T) + alignment - 1) / alignment * alignment;
        if (blocks_.empty() || blocks_.back().size - used_ < bytes) add_block(bytes);
        void* place = blocks_.back().memory + used_;
        used_ += bytes;
        return static_cast<T*>(place);
    }

    void reset() {
        if (blocks_.size() > 1) {
            std::size_t total = 0;
            for (block& b : blocks_) {
                total += b.size;
                std::free(b.memory);
            }
            blocks_.clear();
            add_block(total);
        }
        used_ = blocks_.empty() ? 0 : start(blocks_.back());
    }

    /// How much has been taken, for rewind().
    struct mark {
        std::uint32_t blocks;
        std::size_t used;
    };
    [[nodiscard]] mark here() const { return {blocks_.size(), used_}; }
    /// Gives back what was taken since, unless that needed another block.
    void rewind(const mark& to) {
        if (to.blocks == blocks_.size()) used_ = to.used;
    }

    /// Bytes that the arena holds.
    [[nodiscard]] std::size_t capacity() const {
        std::size_t total = 0;
        for (const block& b : blocks_) total += b.size;
        return total;
    }

private:
    static constexpr std::size_t alignment = alignof(std::max_align_t) < 16 ? 16 : alignof(std::max_align_t);
    struct block {
        unsigned char* memory;
        std::size_t size;
    };
    /// Where a block's first aligned byte is: malloc aligns to 8 bytes only on some systems.
    static std::size_t start(const block& b) {
        return (alignment - reinterpret_cast<std::uintptr_t>(b.memory) % alignment) % alignment;
    }

    void swap(arena& other) noexcept {
        blocks_.swap(other.blocks_);
        std::swap(used_, other.used_);
    }
    PHYSICS_HPP_COLD void add_block(std::size_t bytes) {
        std::size_t size = blocks_.empty() ? 4096 : blocks_.back().size * 2;
        if (size < bytes + alignment) size = bytes + alignment;
        blocks_.reserve(blocks_.size() + 1);
        void* memory = std::malloc(size);
        if (memory == nullptr) detail::refuse_memory("arena", static_cast<double>(size));
        blocks_.push_back({static_cast<unsigned char*>(memory), size});
        used_ = start(blocks_.back());
    }

    buffer<block> blocks_;
    std::size_t used_ = 0;
};

PHYSICS_HPP_END
