// Executors: who does the parts of a step's work, on one thread or on several.
#pragma once

#include <concepts>

#include "physics/base/arena.hpp"
#include "physics/base/probe.hpp"

PHYSICS_HPP_BEGIN

/// Work in parts, as executors get it: to be called once with the number of each part, and with that of the worker who
/// does it. It throws nothing, and may be called from any thread. Where it is called again with the same part it does
/// nothing, and the step is refused.
class work {
public:
    /// done: a note for each part, or null.
    template <class F>
    work(F& f, unsigned char* done, std::uint32_t parts, std::uint32_t workers)
        : f_(&f),
          call_([](void* of, std::uint32_t part, std::uint32_t worker) { (*static_cast<F*>(of))(part, worker); }),
          done_(done),
          parts_(parts),
          workers_(workers) {
        for (std::uint32_t k = 0; done != nullptr && k < parts; ++k) done[k] = 0;
    }

    void operator()(std::uint32_t part, std::uint32_t worker) const {
        if (!(part < parts_ && worker < workers_)) return;
        if (done_ != nullptr && (note(part, begun) & begun) != 0) {
            note(part, again);
            return;
        }
        const float_control_scope control;
        call_(f_, part, worker);
        if (done_ != nullptr) note(part, ended);
    }

    /// What is noted of a part.
    static constexpr unsigned char begun = 1, ended = 2, again = 4;

private:
    /// Says what was noted before, also where two threads do the same part.
    unsigned char note(std::uint32_t part, unsigned char what) const {
#if defined(__GNUC__)
        return __atomic_fetch_or(done_ + part, what, __ATOMIC_ACQ_REL);
#else
        const unsigned char before = done_[part];
        done_[part] = static_cast<unsigned char>(before | what);
        return before;
#endif
    }

    void* f_;
    void (*call_)(void*, std::uint32_t, std::uint32_t);
    unsigned char* done_;
    std::uint32_t parts_, workers_;
};

/// Who may be handed to world::step. workers(): how many can be at work at a time, at least 1, and the same for a whole
/// step. run(parts, what): calls what(part, worker) once for every part below `parts`, in any order, with numbers of
/// workers below workers(), never two calls with the same one at a time, and returns when all are done. Results do not
/// depend on any of it.
template <class E>
concept executor = requires(E& e, const work& what) {
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

/// An executor without its type, or nobody but the caller.
class crew {
public:
    crew() = default;
    /// scratch: is prepared for all workers before they work.
    template <executor E>
    crew(E& of, buffer<unsigned char>& done, per_worker<arena>& scratch)
        : executor_(&of),
          run_([](void* e, std::uint32_t parts, const work& what) { static_cast<E*>(e)->run(parts, what); }),
          done_(&done),
          scratch_(&scratch),
          workers_(static_cast<std::uint32_t>(of.workers())),
          is_ours_(std::same_as<E, thread_pool>) {}

    [[nodiscard]] std::uint32_t workers() const { return workers_; }
    [[nodiscard]] bool is_alone() const { return workers_ == 1; }
    /// Whether all parts have been done so far.
    [[nodiscard]] bool is_sound() const { return sound_; }
    /// The scratch memory of a worker; of the caller if there is nobody else.
    [[nodiscard]] arena& scratch_of(std::uint32_t worker, arena& of_caller) const {
        return is_alone() ? of_caller : (*scratch_)[worker];
    }

    /// Calls f(part, worker) for all parts. What the executor leaves out is done here, so that no stage finds anything
    /// half made before the step is refused.
    template <class F>
    void each(std::uint32_t parts, F&& f) {
        if (is_alone() || parts < 2) {
            for (std::uint32_t k = 0; k < parts; ++k) f(k, 0);
            return;
        }
        // Our pool calls every part, once; to note it would take workers a look at each other's notes.
        if (is_ours_) return run_(executor_, parts, work(f, nullptr, parts, workers_));
        done_->resize(parts);
        run_(executor_, parts, work(f, done_->begin(), parts, workers_));
        for (std::uint32_t k = 0; k < parts; ++k) {
            const unsigned char noted = (*done_)[k];
            if (noted != (work::begun | work::ended)) sound_ = false;
            if ((noted & work::ended) == 0) f(k, 0);
        }
    }
    /// Calls f(first, end, worker) for all of `count` things, in parts of `share`.
    template <class F>
    void each_part(std::uint32_t count, std::uint32_t share, F&& f) {
        each(count / share + (count % share > 0), [&](std::uint32_t part, std::uint32_t worker) {
            const std::uint32_t first = part * share;
            f(first, count - first < share ? count : first + share, worker);
        });
    }

    /// One of several equal parts of anything.
    struct equal_part {
        std::uint32_t number, parts;

        [[nodiscard]] std::uint32_t begin_in(std::uint32_t count) const {
            return static_cast<std::uint32_t>(std::uint64_t{count} * number / parts);
        }
        [[nodiscard]] std::uint32_t end_in(std::uint32_t count) const {
            return equal_part{number + 1, parts}.begin_in(count);
        }
    };
    /// Calls f(part, worker) for all parts of what is worth cutting into at most so many: each worker has the same
    /// share every time, if the executor lets it, so that what it is about stays in its caches.
    template <class F>
    void each_share(std::uint32_t most, F&& f) {
        std::uint32_t parts = is_alone() || most == 0 ? 1 : most;
        if (parts > workers_ * parts_each) parts = workers_ * parts_each;
        each(parts, [&](std::uint32_t number, std::uint32_t worker) { f(equal_part{number, parts}, worker); });
    }
    /// Calls f(first, end, worker) for all of `count` things, in such parts of at least `least`.
    template <class F>
    void each_range(std::uint32_t count, std::uint32_t least, F&& f) {
        if (count == 0) return;
        each_share(count / least,
                   [&](equal_part of, std::uint32_t worker) { f(of.begin_in(count), of.end_in(count), worker); });
    }

private:
    /// So many parts for each worker: others take the last ones where it is late.
    static constexpr std::uint32_t parts_each = 4;

    void* executor_ = nullptr;
    void (*run_)(void*, std::uint32_t, const work&) = nullptr;
    buffer<unsigned char>* done_ = nullptr;
    per_worker<arena>* scratch_ = nullptr;
    std::uint32_t workers_ = 1;
    bool is_ours_ = false, sound_ = true;
};

}  // namespace detail

PHYSICS_HPP_END
