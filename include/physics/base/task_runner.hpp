// Executors: run the tasks of a step on one thread or on several.
#pragma once

#include <concepts>

#include "physics/base/arena.hpp"
#include "physics/base/probe.hpp"

PHYSICS_HPP_BEGIN

namespace detail {
class task_runner;
}

/// A set of numbered tasks, as an executor gets it. Call it once with each task's number and the number of the worker
/// that runs it. It throws nothing and may be called from any thread. A second call with the same task does nothing,
/// and the step is refused.
class task_set {
public:
    /// done: a note for each part, or null.
    template <class F>
    task_set(F& f, unsigned char* done, std::uint32_t task_count, std::uint32_t workers)
        : f_(&f),
          call_([](void* of, std::uint32_t task, std::uint32_t worker) { (*static_cast<F*>(of))(task, worker); }),
          done_(done),
          task_count_(task_count),
          workers_(workers) {
        for (std::uint32_t k = 0; done != nullptr && k < task_count; ++k) done[k] = 0;
    }

    void operator()(std::uint32_t task, std::uint32_t worker) const {
        if (!(task < task_count_ && worker < workers_)) return;
        if (done_ != nullptr && (note(task, begun) & begun) != 0) {
            note(task, again);
            return;
        }
        const float_control_scope control;
        // No exception leaves a worker.
        if (!detail::run_if_memory_lasts([&] { call_(f_, task, worker); }) && out_of_memory_ != nullptr)
            set(*out_of_memory_);
        if (done_ != nullptr) note(task, ended);
    }

private:
    friend class detail::task_runner;
    /// What is noted of a part.
    static constexpr unsigned char begun = 1, ended = 2, again = 4;

    /// Says what was noted before, also where two threads do the same part.
    unsigned char note(std::uint32_t task, unsigned char what) const {
#if defined(__GNUC__)
        return __atomic_fetch_or(done_ + task, what, __ATOMIC_ACQ_REL);
#else
        const unsigned char before = done_[task];
        done_[task] = static_cast<unsigned char>(before | what);
        return before;
#endif
    }

    static void set(unsigned char& flag) {
#if defined(__GNUC__)
        __atomic_store_n(&flag, static_cast<unsigned char>(1), __ATOMIC_RELEASE);
#else
        flag = 1;
#endif
    }

    void* f_;
    void (*call_)(void*, std::uint32_t, std::uint32_t);
    unsigned char* done_;
    /// Set where a task finds no memory.
    unsigned char* out_of_memory_ = nullptr;
    std::uint32_t task_count_, workers_;
};

/// What world::step can use to run tasks. workers(): how many tasks may run at a time, at least 1, the same for a whole
/// step. run(count, tasks): calls tasks(task, worker) once for every task below `count`, in any order, with worker
/// numbers below workers(), never two calls with the same worker at a time, and returns when all are done. Results do
/// not depend on the order or on the workers.
template <class E>
concept executor = requires(E& e, const task_set& what) {
    { e.workers() } -> std::convertible_to<std::uint32_t>;
    e.run(std::uint32_t{}, what);
};

/// See base/thread_pool.hpp.
class thread_pool;

namespace detail {

/// One T for each worker, which outlive a step so that their memory does. A copy starts with fresh ones.
template <class T>
class per_worker {
public:
    using is_scratch = void;

    per_worker() = default;
    per_worker(const per_worker&) {}
    per_worker(per_worker&& other) noexcept { swap(other); }
    per_worker& operator=(const per_worker&) { return *this; }
    per_worker& operator=(per_worker&& other) noexcept {
        per_worker taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~per_worker() { delete[] more_; }

    T& operator[](std::uint32_t worker) { return worker == 0 ? first_ : more_[worker - 1]; }
    void prepare(std::uint32_t workers) {
        if (workers <= count_) return;
        T* const more = new T[workers - 1];
        for (std::uint32_t k = 1; k < count_; ++k) more[k - 1] = std::move(more_[k - 1]);
        delete[] more_;
        more_ = more;
        count_ = workers;
    }

private:
    void swap(per_worker& other) noexcept {
        std::swap(first_, other.first_);
        std::swap(more_, other.more_);
        std::swap(count_, other.count_);
    }

    T first_;
    T* more_ = nullptr;
    std::uint32_t count_ = 1;
};

/// A type-erased executor; without one, all tasks run on the calling thread.
class task_runner {
public:
    task_runner() = default;
    /// scratch: is prepared for all workers before they work.
    template <executor E>
    task_runner(E& of, buffer<unsigned char>& done, per_worker<arena>& scratch)
        : executor_(&of),
          run_([](void* e, std::uint32_t task_count, const task_set& what) {
              static_cast<E*>(e)->run(task_count, what);
          }),
          done_(&done),
          scratch_(&scratch),
          workers_(static_cast<std::uint32_t>(of.workers())),
          is_own_pool_(std::same_as<E, thread_pool>) {}

    [[nodiscard]] std::uint32_t workers() const { return workers_; }
    [[nodiscard]] bool is_serial() const { return workers_ == 1; }
    /// Whether all parts have been done so far.
    [[nodiscard]] bool ran_all_tasks() const { return ran_all_; }
    /// The scratch memory of a worker; the caller's if there is one worker only.
    [[nodiscard]] arena& scratch_of(std::uint32_t worker, arena& of_caller) const {
        return is_serial() ? of_caller : (*scratch_)[worker];
    }

    /// Calls f(part, worker) for all parts.
    template <class F>
    void parallel_tasks(std::uint32_t task_count, F&& f) {
        if (!is_serial() && task_count > 1) return run_on_executor(task_set(f, nullptr, task_count, workers_));
        for (std::uint32_t k = 0; k < task_count; ++k) f(k, 0);
    }
    /// Calls f(first, end, worker) for all of `count` things, in parts of `share`.
    template <class F>
    void parallel_chunks(std::uint32_t count, std::uint32_t share, F&& f) {
        parallel_tasks(count / share + (count % share > 0), [&](std::uint32_t task, std::uint32_t worker) {
            const std::uint32_t first = task * share;
            f(first, count - first < share ? count : first + share, worker);
        });
    }

    /// One of several equal parts of anything.
    struct slice {
        std::uint32_t number, task_count;

        [[nodiscard]] std::uint32_t begin_in(std::uint32_t count) const {
            return static_cast<std::uint32_t>(std::uint64_t{count} * number / task_count);
        }
        [[nodiscard]] std::uint32_t end_in(std::uint32_t count) const {
            return slice{number + 1, task_count}.begin_in(count);
        }
    };
    /// Calls f(part, worker) for all parts of what is worth cutting into at most so many: each worker has the same
    /// share every time, if the executor lets it, so that what it is about stays in its caches.
    template <class F>
    void for_each_slice(std::uint32_t maximum, F&& f) {
        std::uint32_t task_count = is_serial() || maximum == 0 ? 1 : maximum;
        if (task_count > workers_ * tasks_per_worker) task_count = workers_ * tasks_per_worker;
        parallel_tasks(task_count, [&](std::uint32_t number, std::uint32_t worker) {
            f(slice{number, task_count}, worker);
        });
    }
    /// Calls f(first, end, worker) for all of `count` things, in such parts of at least `minimum`.
    template <class F>
    void parallel_for(std::uint32_t count, std::uint32_t minimum, F&& f) {
        if (count == 0) return;
        for_each_slice(count / minimum,
                       [&](slice of, std::uint32_t worker) { f(of.begin_in(count), of.end_in(count), worker); });
    }

private:
    /// So many parts for each worker: others take the last ones where it is late.
    static constexpr std::uint32_t tasks_per_worker = 4;

    /// What the executor leaves out is done here, so that no stage finds anything half made before the step is refused.
    PHYSICS_HPP_COLD void run_on_executor(task_set tasks) {
        unsigned char lacks = 0;
        tasks.out_of_memory_ = &lacks;
        run_noted(tasks);
        if (lacks != 0) refuse_memory("step", 0);
    }
    void run_noted(task_set& tasks) {
        const std::uint32_t count = tasks.task_count_;
        // Our pool calls every part, once; to note it would take workers a look at each other's notes.
        if (is_own_pool_) return run_(executor_, count, tasks);
        done_->clear();
        done_->resize(count);
        tasks.done_ = done_->begin();
        run_(executor_, count, tasks);
        for (std::uint32_t k = 0; k < count; ++k) {
            const unsigned char noted = tasks.done_[k];
            if (noted != (task_set::begun | task_set::ended)) ran_all_ = false;
            if ((noted & task_set::ended) == 0) tasks.call_(tasks.f_, k, 0);
        }
    }

    void* executor_ = nullptr;
    void (*run_)(void*, std::uint32_t, const task_set&) = nullptr;
    buffer<unsigned char>* done_ = nullptr;
    per_worker<arena>* scratch_ = nullptr;
    std::uint32_t workers_ = 1;
    bool is_own_pool_ = false, ran_all_ = true;
};

}  // namespace detail

PHYSICS_HPP_END
