// The thread pool: an executor of our own; apart, as <thread> is dear: define PHYSICS_HPP_THREADS to get it.
#pragma once

#include <atomic>
#include <thread>

#include "physics/base/crew.hpp"

PHYSICS_HPP_BEGIN

/// Threads that wait for work: hand one to world::step. Worlds may share a pool, one after the other. Each worker
/// begins with parts of its own, the same ones whenever there are as many, so that what they are about is still in its
/// caches. Then it takes what others have not begun, at once from those who are away, and after a moment from those
/// who are at work: so who is late, on a busy machine, delays the others by the part that it is in at most. A worker
/// that finds nothing to do looks on for a while; then it sleeps, so that an idle pool costs nothing.
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
        shares_ = new share[workers];
        threads_ = new std::thread[workers - 1];
        // The system may refuse a thread and throw: then those before are told to go.
        for (; started_ < workers; ++started_)
            threads_[started_ - 1] = std::thread([this, worker = started_] { serve(worker); });
        workers_ = workers;
    }
    ~thread_pool() {
        for (std::uint32_t k = 1; k < started_; ++k) shares_[k].left.store(closed);
        call();
        for (std::uint32_t k = 1; k < started_; ++k) threads_[k - 1].join();
        delete[] threads_;
        delete[] shares_;
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

    /// The parts of a worker that are left: which round of work it is, after the last one, and the next. Who takes the
    /// next does so in one operation. In a line of its own, where only its worker looks as long as it is not late. No
    /// round is that of `closed`.
    struct alignas(64) share {
        std::atomic<std::uint64_t> left{0};
        /// Whether the worker has lately been seen at work.
        std::atomic<bool> at_work{false};
    };
    static constexpr std::uint32_t most = 256, most_parts = (1u << 24) - 1;
    static constexpr std::uint64_t closed = ~std::uint64_t{0};
    static std::uint32_t next_of(std::uint64_t left) { return static_cast<std::uint32_t>(left & most_parts); }
    static std::uint32_t end_of(std::uint64_t left) { return static_cast<std::uint32_t>(left >> 24 & most_parts); }
    static std::uint32_t round_of(std::uint64_t left) { return static_cast<std::uint32_t>(left >> 48); }

    void run_some(std::uint32_t first, std::uint32_t parts, const work& what) {
        if (workers_ == 1) {
            for (std::uint32_t k = 0; k < parts; ++k) what(first + k, 0);
            return;
        }
        first_ = first;
        what_ = &what;
        done_.store(0, std::memory_order_relaxed);
        round_ = round_ + 1 < round_of(closed) ? round_ + 1 : 0;
        const std::uint32_t each = parts / workers_, more = parts % workers_;
        std::uint32_t end = parts;
        for (std::uint32_t k = workers_; k-- > 0;) {
            const std::uint32_t next = end - each - (k < more);
            // The caller has taken the first: others hear of theirs while it does that.
            shares_[k].left.store(std::uint64_t{round_} << 48 | std::uint64_t{end} << 24 | (next + (k == 0)),
                                  std::memory_order_release);
            end = next;
        }
        if (sleepers_.load(std::memory_order_relaxed) > 0) call();
        what(first, 0);
        // Who was about to sleep has seen the parts, or is seen here.
        done_.fetch_add(1);
        if (sleepers_.load() > 0) call();
        done_.fetch_add(work_as(0), std::memory_order_relaxed);
        wait_for(parts);
    }
    /// Does what is left of the worker's own parts, then of the others'; says how many.
    std::uint32_t work_as(std::uint32_t worker) {
        std::uint32_t count = 0, part = 0, waited = 0;
        for (; take(shares_[worker], part); ++count) {
            // As seldom as can be: others look at this line.
            if (count == 0 && worker != 0 && !shares_[worker].at_work.load(std::memory_order_relaxed))
                shares_[worker].at_work.store(true, std::memory_order_relaxed);
            (*what_)(first_ + part, worker);
        }
        for (std::uint32_t k = 1; k < workers_; ++k) {
            share& of = shares_[(worker + k) % workers_];
            for (; is_left(of) && of.at_work.load(std::memory_order_relaxed) && waited < courtesy; ++waited) relax();
            for (; take(of, part); ++count) {
                if (of.at_work.load(std::memory_order_relaxed)) of.at_work.store(false, std::memory_order_relaxed);
                (*what_)(first_ + part, worker);
            }
        }
        return count;
    }
    static bool is_left(const share& of) {
        const std::uint64_t left = of.left.load(std::memory_order_relaxed);
        return next_of(left) < end_of(left);
    }
    static bool take(share& of, std::uint32_t& part) {
        std::uint64_t left = of.left.load(std::memory_order_relaxed);
        while (next_of(left) < end_of(left)) {
            part = next_of(left);
            if (of.left.compare_exchange_weak(left, left + 1, std::memory_order_acquire, std::memory_order_relaxed))
                return true;
        }
        return false;
    }
    /// Waits until so many parts are done: a short wait costs no call of the system.
    void wait_for(std::uint32_t parts) {
        for (std::uint32_t k = 0; k < patience; ++k) {
            if (done_.load(std::memory_order_acquire) == parts) return;
            relax();
        }
        std::uint32_t seen = done_.fetch_or(awaited, std::memory_order_acq_rel) | awaited;
        while (seen != (parts | awaited)) {
            done_.wait(seen, std::memory_order_acquire);
            seen = done_.load(std::memory_order_acquire);
        }
    }
    void serve(std::uint32_t worker) {
        const std::atomic<std::uint64_t>& own = shares_[worker].left;
        for (std::uint32_t round = 0, idle = 0;;) {
            const std::uint64_t left = own.load(std::memory_order_acquire);
            if (left == closed) return;
            if (round_of(left) != round) {
                round = round_of(left);
                idle = 0;
                const std::uint32_t count = work_as(worker);
                if (count > 0 && (done_.fetch_add(count, std::memory_order_acq_rel) & awaited) != 0) done_.notify_one();
            } else if (++idle < patience) {
                relax();
            } else {
                const std::uint32_t before = calls_.load();
                shares_[worker].at_work.store(false, std::memory_order_relaxed);
                sleepers_.fetch_add(1);
                if (round_of(own.load()) == round) calls_.wait(before);
                idle = 0;
            }
        }
    }
    /// Wakes all that sleep, once: they may take long to come.
    void call() {
        sleepers_.store(0);
        calls_.fetch_add(1);
        calls_.notify_all();
    }
    static void relax() {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#else
        std::atomic_signal_fence(std::memory_order_seq_cst);
#endif
    }

    /// Looks before a worker sleeps, and before it takes what is another's who is at work: 20 to 50 ns each.
    static constexpr std::uint32_t patience = 2000, courtesy = 100, awaited = 1u << 31;

    std::uint32_t workers_ = 1, started_ = 1;
    std::thread* threads_ = nullptr;
    share* shares_ = nullptr;
    std::uint32_t round_ = 0, first_ = 0;
    const work* what_ = nullptr;
    /// How many parts are done, and whether the caller sleeps until they are.
    alignas(64) std::atomic<std::uint32_t> done_{0};
    alignas(64) std::atomic<std::uint32_t> calls_{0};
    alignas(64) std::atomic<std::uint32_t> sleepers_{0};
};

PHYSICS_HPP_END
