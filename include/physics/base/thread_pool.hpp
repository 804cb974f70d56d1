// The thread pool: an executor of our own; apart, as <thread> is dear: define PHYSICS_HPP_THREADS to get it.
#pragma once

#include <atomic>
#include <thread>

#include "physics/base/crew.hpp"

PHYSICS_HPP_BEGIN

/// Threads that wait for work: hand one to world::step. Worlds may share a pool, one after the other. Between the parts
/// of a step workers look for work without sleeping, for a while; then they sleep, so that an idle pool costs nothing.
class thread_pool {
public:
    /// A pool of so many workers, of whom the caller of run is one; 0: as many as the machine has. At most 256.
    explicit thread_pool(std::uint32_t workers = 0) : thread_pool(nobody{}) {
        if (workers == 0) workers = std::thread::hardware_concurrency();
        if (workers > most) {
            detail::refuse("thread_pool", "workers", static_cast<double>(workers), "it must be at most 256");
            return;
        }
        if (workers < 2) return;
        threads_ = new std::thread[workers - 1];
        // The system may refuse a thread and throw: then those before are told to go.
        for (; workers_ < workers; ++workers_)
            threads_[workers_ - 1] = std::thread([this, worker = workers_] { serve(worker); });
    }
    ~thread_pool() {
        ticket_.store(closed, std::memory_order_release);
        ticket_.notify_all();
        for (std::uint32_t k = 1; k < workers_; ++k) threads_[k - 1].join();
        delete[] threads_;
    }
    thread_pool(const thread_pool&) = delete;
    thread_pool& operator=(const thread_pool&) = delete;

    [[nodiscard]] std::uint32_t workers() const { return workers_; }

    /// Calls what(part, worker) for all parts, and returns when they are done. One caller at a time.
    void run(std::uint32_t parts, const work& what) {
        for (std::uint32_t first = 0; first < parts;) {
            const std::uint32_t some = parts - first < most_parts ? parts - first : most_parts;
            run_some(first, some, what);
            first += some;
        }
    }

private:
    /// A pool that is complete, so that it is destroyed whatever happens to those who are to work in it.
    struct nobody {};
    explicit thread_pool(nobody) {}

    // A ticket says which round of work it is, how many parts that has, and which of them is the next: it is taken in
    // one operation, so that whoever comes late takes nothing, or a part of the next round. None is ever `closed`.
    static constexpr std::uint32_t most = 256, most_parts = (1u << 24) - 2 * most;
    static constexpr std::uint64_t closed = ~std::uint64_t{0};
    static std::uint32_t next_of(std::uint64_t ticket) { return static_cast<std::uint32_t>(ticket & 0xffffffu); }
    static std::uint32_t parts_of(std::uint64_t ticket) { return static_cast<std::uint32_t>(ticket >> 24 & 0xffffffu); }
    static bool has_work(std::uint64_t ticket) { return next_of(ticket) < parts_of(ticket); }

    void run_some(std::uint32_t first, std::uint32_t parts, const work& what) {
        first_ = first;
        what_ = &what;
        done_.store(0, std::memory_order_relaxed);
        round_ = (round_ + 1) & 0xffffu;
        ticket_.store(std::uint64_t{round_} << 48 | std::uint64_t{parts} << 24);
        if (sleepers_.load() > 0) ticket_.notify_all();
        work_as(0);
        while (done_.load(std::memory_order_acquire) != parts) relax();
    }
    void work_as(std::uint32_t worker) {
        std::uint64_t mine = ticket_.load(std::memory_order_relaxed);
        while (has_work(mine)) {
            if (!ticket_.compare_exchange_weak(mine, mine + 1, std::memory_order_acquire, std::memory_order_relaxed))
                continue;
            (*what_)(first_ + next_of(mine), worker);
            done_.fetch_add(1, std::memory_order_release);
            mine = ticket_.load(std::memory_order_relaxed);
        }
    }
    void serve(std::uint32_t worker) {
        for (std::uint32_t idle = 0;;) {
            const std::uint64_t seen = ticket_.load(std::memory_order_acquire);
            if (seen == closed) return;
            if (has_work(seen)) {
                work_as(worker);
                idle = 0;
            } else if (++idle < patience) {
                relax();
            } else {
                sleepers_.fetch_add(1);
                ticket_.wait(seen);
                sleepers_.fetch_sub(1);
                idle = 0;
            }
        }
    }
    static void relax() {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#else
        std::atomic_signal_fence(std::memory_order_seq_cst);
#endif
    }

    static constexpr std::uint32_t patience = 2000;

    std::uint32_t workers_ = 1;
    std::thread* threads_ = nullptr;
    std::uint32_t round_ = 0, first_ = 0;
    const work* what_ = nullptr;
    alignas(64) std::atomic<std::uint64_t> ticket_{0};
    alignas(64) std::atomic<std::uint32_t> done_{0};
    alignas(64) std::atomic<std::uint32_t> sleepers_{0};
};

PHYSICS_HPP_END
