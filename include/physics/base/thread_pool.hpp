// The thread pool: an executor of our own; apart, as <thread> is dear: define PHYSICS_HPP_THREADS to get it.
#pragma once

#include <atomic>
#include <thread>

#include "physics/base/task_runner.hpp"

PHYSICS_HPP_BEGIN

/// A pool of worker threads for world::step. Several worlds may use a pool one after the other. Each worker starts with
/// its own range of tasks, the same for the same number of tasks, so that its data is still in its caches. Then it
/// steals from other workers: at once from idle ones, after a short wait from busy ones; so a worker that the system
/// has descheduled delays the others by one task at most. An idle worker spins for a while, then sleeps.
class thread_pool {
public:
    /// A pool of this many workers, the caller of run included; 0: as many as the machine has. At most 256.
    explicit thread_pool(std::uint32_t workers = 0) : thread_pool(no_threads{}) {
        if (workers == 0) workers = std::thread::hardware_concurrency();
        if (workers > max_workers) {
            detail::refuse("thread_pool", "workers", static_cast<double>(workers), "it must be at most 256");
            return;
        }
        if (workers < 2) return;
        ranges_ = new task_range[workers];
        threads_ = new std::thread[workers - 1];
        // The system may refuse a thread and throw: then those before are told to go.
        for (; started_ < workers; ++started_)
            threads_[started_ - 1] = std::thread([this, worker = started_] { serve(worker); });
        workers_ = workers;
    }
    ~thread_pool() {
        for (std::uint32_t k = 1; k < started_; ++k) ranges_[k].left.store(closed);
        call();
        for (std::uint32_t k = 1; k < started_; ++k) threads_[k - 1].join();
        delete[] threads_;
        delete[] ranges_;
    }
    thread_pool(const thread_pool&) = delete;
    thread_pool& operator=(const thread_pool&) = delete;

    [[nodiscard]] std::uint32_t workers() const { return workers_; }

    /// Calls what(part, worker) for all parts, and returns when they are done. One caller at a time.
    void run(std::uint32_t task_count, const task_set& tasks) {
        for (std::uint32_t first = 0; first < task_count;) {
            const std::uint32_t some = task_count - first < max_tasks ? task_count - first : max_tasks;
            run_some(first, some, tasks);
            first += some;
        }
    }

private:
    /// Selects a constructor that starts no threads: the destructor then runs if a later one throws.
    struct no_threads {};
    explicit thread_pool(no_threads) {}

    /// The remaining task range of a worker: round number, end, next task, packed so that a task is claimed by one
    /// atomic operation. On a cache line of its own, which other workers read only when they steal. No round has the
    /// number of `closed`.
    struct alignas(64) task_range {
        std::atomic<std::uint64_t> left{0};
        /// Whether the worker has lately been seen at work.
        std::atomic<bool> at_work{false};
    };
    static constexpr std::uint32_t max_workers = 256, max_tasks = (1u << 24) - 1;
    static constexpr std::uint64_t closed = ~std::uint64_t{0};
    static std::uint32_t next_of(std::uint64_t left) { return static_cast<std::uint32_t>(left & max_tasks); }
    static std::uint32_t end_of(std::uint64_t left) { return static_cast<std::uint32_t>(left >> 24 & max_tasks); }
    static std::uint32_t round_of(std::uint64_t left) { return static_cast<std::uint32_t>(left >> 48); }

    void run_some(std::uint32_t first, std::uint32_t task_count, const task_set& tasks) {
        if (workers_ == 1) {
            for (std::uint32_t k = 0; k < task_count; ++k) tasks(first + k, 0);
            return;
        }
        first_ = first;
        tasks_ = &tasks;
        done_.store(0, std::memory_order_relaxed);
        round_ = round_ + 1 < round_of(closed) ? round_ + 1 : 0;
        const std::uint32_t each = task_count / workers_, more = task_count % workers_;
        std::uint32_t end = task_count;
        for (std::uint32_t k = workers_; k-- > 0;) {
            const std::uint32_t next = end - each - (k < more);
            // The caller has taken the first: others hear of theirs while it does that.
            ranges_[k].left.store(std::uint64_t{round_} << 48 | std::uint64_t{end} << 24 | (next + (k == 0)),
                                  std::memory_order_release);
            end = next;
        }
        if (sleepers_.load(std::memory_order_relaxed) > 0) call();
        tasks(first, 0);
        // A worker that was about to sleep has seen the tasks, or is seen here.
        done_.fetch_add(1);
        if (sleepers_.load() > 0) call();
        done_.fetch_add(run_as(0), std::memory_order_relaxed);
        wait_for(task_count);
    }
    /// Does what is left of the worker's own parts, then of the others'; says how many.
    std::uint32_t run_as(std::uint32_t worker) {
        std::uint32_t count = 0, task = 0, waited = 0;
        for (; claim(ranges_[worker], task); ++count) {
            // As seldom as can be: others look at this line.
            if (count == 0 && worker != 0 && !ranges_[worker].at_work.load(std::memory_order_relaxed))
                ranges_[worker].at_work.store(true, std::memory_order_relaxed);
            (*tasks_)(first_ + task, worker);
        }
        for (std::uint32_t k = 1; k < workers_; ++k) {
            task_range& of = ranges_[(worker + k) % workers_];
            for (; is_left(of) && of.at_work.load(std::memory_order_relaxed) && waited < steal_delay; ++waited)
                cpu_pause();
            for (; claim(of, task); ++count) {
                if (of.at_work.load(std::memory_order_relaxed)) of.at_work.store(false, std::memory_order_relaxed);
                (*tasks_)(first_ + task, worker);
            }
        }
        return count;
    }
    static bool is_left(const task_range& of) {
        const std::uint64_t left = of.left.load(std::memory_order_relaxed);
        return next_of(left) < end_of(left);
    }
    static bool claim(task_range& of, std::uint32_t& task) {
        std::uint64_t left = of.left.load(std::memory_order_relaxed);
        while (next_of(left) < end_of(left)) {
            task = next_of(left);
            if (of.left.compare_exchange_weak(left, left + 1, std::memory_order_acquire, std::memory_order_relaxed))
                return true;
        }
        return false;
    }
    /// Waits until so many parts are done: a short wait costs no call of the system.
    void wait_for(std::uint32_t task_count) {
        for (std::uint32_t k = 0; k < spin_limit; ++k) {
            if (done_.load(std::memory_order_acquire) == task_count) return;
            cpu_pause();
        }
        std::uint32_t seen = done_.fetch_or(awaited, std::memory_order_acq_rel) | awaited;
        while (seen != (task_count | awaited)) {
            done_.wait(seen, std::memory_order_acquire);
            seen = done_.load(std::memory_order_acquire);
        }
    }
    void serve(std::uint32_t worker) {
        const std::atomic<std::uint64_t>& own = ranges_[worker].left;
        for (std::uint32_t round = 0, idle = 0;;) {
            const std::uint64_t left = own.load(std::memory_order_acquire);
            if (left == closed) return;
            if (round_of(left) != round) {
                round = round_of(left);
                idle = 0;
                const std::uint32_t count = run_as(worker);
                if (count > 0 && (done_.fetch_add(count, std::memory_order_acq_rel) & awaited) != 0) done_.notify_one();
            } else if (++idle < spin_limit) {
                cpu_pause();
            } else {
                const std::uint32_t before = calls_.load();
                ranges_[worker].at_work.store(false, std::memory_order_relaxed);
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
    static void cpu_pause() {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#else
        std::atomic_signal_fence(std::memory_order_seq_cst);
#endif
    }

    /// Spins before a worker sleeps, and before it steals from a busy worker: 20 to 50 ns each.
    static constexpr std::uint32_t spin_limit = 2000, steal_delay = 100, awaited = 1u << 31;

    std::uint32_t workers_ = 1, started_ = 1;
    std::thread* threads_ = nullptr;
    task_range* ranges_ = nullptr;
    std::uint32_t round_ = 0, first_ = 0;
    const task_set* tasks_ = nullptr;
    /// How many parts are done, and whether the caller sleeps until they are.
    alignas(64) std::atomic<std::uint32_t> done_{0};
    alignas(64) std::atomic<std::uint32_t> calls_{0};
    alignas(64) std::atomic<std::uint32_t> sleepers_{0};
};

PHYSICS_HPP_END
