// Sorting: numbers in linear time, and anything in place.
#pragma once

#include <cstring>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Sorts keys by their bits from `low` to below `high`, those that are alike in the order in which they came. Returns
/// where the sorted keys are: in `keys`, or in `scratch`, which has room for as many. Cost: 2 ns a key for every 8 to
/// 11 bits in which keys differ. Source: radix sort from the least digit (Seward 1954).
inline std::uint64_t* radix_sort(std::uint64_t* keys, std::uint64_t* scratch, std::uint32_t count, int low, int high) {
    if (count <= 48) {
        const std::uint64_t mask =
            high - low >= 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << (high - low)) - 1) << low;
        for (std::uint32_t i = 1; i < count; ++i) {
            const std::uint64_t key = keys[i];
            std::uint32_t k = i;
            for (; k > 0 && (keys[k - 1] & mask) > (key & mask); --k) keys[k] = keys[k - 1];
            keys[k] = key;
        }
        return keys;
    }
    const int maximum = count < 4096 ? 8 : 11;
    const int passes = (high - low + maximum - 1) / maximum;
    for (int pass = 0; pass < passes; ++pass) {
        // Digits of even width: a last one of few bits would cost as much as a full one.
        const int from = low + (high - low) * pass / passes, to = low + (high - low) * (pass + 1) / passes;
        const std::uint32_t buckets = 1u << (to - from);
        std::uint32_t starts[2048];
        std::memset(starts, 0, buckets * sizeof *starts);
        for (std::uint32_t i = 0; i < count; ++i) ++starts[keys[i] >> from & (buckets - 1)];
        if (starts[keys[0] >> from & (buckets - 1)] == count) continue;
        std::uint32_t sum = 0;
        for (std::uint32_t b = 0; b < buckets; ++b) {
            const std::uint32_t here = starts[b];
            starts[b] = sum;
            sum += here;
        }
        for (std::uint32_t i = 0; i < count; ++i) scratch[starts[keys[i] >> from & (buckets - 1)]++] = keys[i];
        std::uint64_t* sorted = scratch;
        scratch = keys;
        keys = sorted;
    }
    return keys;
}

/// Sorts items in place; those that are alike come in any order. O(n log n), O(n^2) up to 24. Source: heapsort
/// (Williams 1964).
template <class T, class Less>
void sort_in_place(T* items, std::uint32_t count, Less&& less) {
    if (count <= 24) {
        for (std::uint32_t i = 1; i < count; ++i) {
            const T item = items[i];
            std::uint32_t k = i;
            for (; k > 0 && less(item, items[k - 1]); --k) items[k] = items[k - 1];
            items[k] = item;
        }
        return;
    }
    const auto sift = [&](std::uint32_t at, std::uint32_t end) {
        const T item = items[at];
        for (std::uint32_t child; (child = 2 * at + 1) < end; at = child) {
            if (child + 1 < end && less(items[child], items[child + 1])) ++child;
            if (!less(item, items[child])) break;
            items[at] = items[child];
        }
        items[at] = item;
    };
    for (std::uint32_t i = count / 2; i-- > 0;) sift(i, count);
    for (std::uint32_t end = count - 1; end > 0; --end) {
        const T last = items[0];
        items[0] = items[end];
        items[end] = last;
        sift(0, end);
    }
}

}  // namespace detail

PHYSICS_HPP_END
