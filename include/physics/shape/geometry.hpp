// Blocks of immutable geometry, such as the vertices of a hull, that many shapes share, and their owners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>

#include "physics/base/error.hpp"

#if !defined(__GNUC__) && !defined(__clang__)
#include <intrin.h>
#endif

PHYSICS_HPP_BEGIN

namespace detail {

/// The head of a block of memory that is filled once and never changes: how many own it. Arrays follow at offsets.
/// Blocks have no destructors; the last release() frees the memory.
struct geometry_block {
    /// What malloc gave; the block begins at the next multiple of `alignment`.
    void* memory = nullptr;
    mutable long owners = 1;
    /// Called, unless null, before the memory goes: with it goes what the block owns.
    void (*gone)(const geometry_block*) = nullptr;

    /// That of cache lines.
    static constexpr std::size_t alignment = 64;
};

/// A block of so many bytes, owned once, its head constructed and the rest zero.
template <class Block>
Block* new_geometry(std::size_t bytes) {
    static_assert(std::is_base_of_v<geometry_block, Block> && std::is_trivially_destructible_v<Block> &&
                  alignof(Block) <= geometry_block::alignment);
    void* memory = std::calloc(bytes + geometry_block::alignment, 1);
    if (memory == nullptr) refuse_memory("geometry", static_cast<double>(bytes));
    const std::uintptr_t place = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t ahead = geometry_block::alignment - place % geometry_block::alignment;
    Block* block = new (static_cast<void*>(static_cast<unsigned char*>(memory) + ahead)) Block;
    block->memory = memory;
    return block;
}

/// One owner more; any thread, null does nothing.
inline void retain(const geometry_block* block) {
    if (block == nullptr) return;
#if defined(__GNUC__) || defined(__clang__)
    __atomic_fetch_add(&block->owners, 1, __ATOMIC_RELAXED);
#else
    _InterlockedIncrement(&block->owners);
#endif
}
/// One owner less; the last one frees the block. Any thread, null does nothing.
inline void release(const geometry_block* block) {
    if (block == nullptr) return;
#if defined(__GNUC__) || defined(__clang__)
    const long left = __atomic_sub_fetch(&block->owners, 1, __ATOMIC_ACQ_REL);
#else
    const long left = _InterlockedDecrement(&block->owners);
#endif
    if (left != 0) return;
    if (block->gone != nullptr) block->gone(block);
    std::free(block->memory);
}

/// One of the owners of a block, or of none: copies share it.
template <class Block>
class geometry_owner {
public:
    geometry_owner() = default;
    /// Takes over the ownership that the caller has.
    explicit geometry_owner(const Block* owned) : block_(owned) {}
    geometry_owner(const geometry_owner& other) : block_(other.block_) { retain(block_); }
    geometry_owner(geometry_owner&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
    geometry_owner& operator=(geometry_owner other) noexcept {
        std::swap(block_, other.block_);
        return *this;
    }
    ~geometry_owner() { release(block_); }

    [[nodiscard]] const Block* get() const { return block_; }

private:
    const Block* block_ = nullptr;
};

}  // namespace detail

PHYSICS_HPP_END
