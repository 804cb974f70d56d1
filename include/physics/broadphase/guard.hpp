// Changes are refused while a query runs.
#pragma once

#include "physics/base/error.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Marks an object as being queried by this thread, as long as the scope lives. A chain on the stack, so that queries
/// of several threads at once write nothing that they share.
class query_scope {
public:
    explicit query_scope(const void* what) : what_(what), outer_(innermost()) { innermost() = this; }
    query_scope(const query_scope&) = delete;
    query_scope& operator=(const query_scope&) = delete;
    ~query_scope() { innermost() = outer_; }

    /// Refuses to change what is being queried.
    static bool allows_change(const void* what, const char* function) {
        for (const query_scope* s = innermost(); s != nullptr; s = s->outer_)
            if (s->what_ == what)
                return refuse(function, "broadphase", "being queried", "it must not change until the query has ended");
        return true;
    }

private:
    static const query_scope*& innermost() {
        constinit static thread_local const query_scope* scope = nullptr;
        return scope;
    }

    const void* what_;
    const query_scope* outer_;
};

}  // namespace detail

PHYSICS_HPP_END
