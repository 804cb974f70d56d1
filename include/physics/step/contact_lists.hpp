// Lists of contacts in ascending order of their pairs, and what is taken out of them.
#pragma once

#include "physics/base/bit_array.hpp"
#include "physics/step/pair_cache.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Keeps, in order, the contacts for which stays(contact) is true, and hands the others to out.
template <class Contacts, class Stays, class Out>
void partition_contacts(Contacts& contacts, Stays&& stays, Out&& out) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (!stays(contacts[i])) {
            out(contacts[i]);
            continue;
        }
        if (kept != i) contacts[kept] = contacts[i];
        ++kept;
    }
    while (contacts.size() > kept) contacts.pop_back();
}
/// Adds contacts to others; both lists, and the result, are in ascending order of their pairs.
template <class Contact>
void merge_contacts(buffer<Contact>& to, const buffer<Contact>& more) {
    std::uint32_t i = to.size(), j = more.size();
    if (j == 0) return;
    to.resize(i + j, more[0]);
    for (std::uint32_t at = to.size(); j > 0;) {
        const bool is_last = i > 0 && more[j - 1].key() < to[i - 1].key();
        to[--at] = is_last ? to[--i] : more[--j];
    }
}

/// Shapes that are destroyed or disabled since the last step, and whether single contacts are gone. What names them in
/// lists of contacts and of memories is no more, and goes with the next step, in one pass for all: until then no other
/// shape of these numbers has any.
class removed_shapes {
public:
    void reserve(std::uint32_t shapes) { is_removed_.reserve(shapes); }
    void make_room(std::uint32_t shapes) { is_removed_.grow(shapes); }
    void add(std::uint32_t shape) { is_removed_.set(shape); }
    /// Removes a single contact.
    template <class Contact>
    void add(Contact& c) {
        c.count = 0;
        any_contact_ = true;
    }
    [[nodiscard]] bool any() const { return any_contact_ || !is_removed_.empty(); }
    [[nodiscard]] bool has(std::uint32_t shape) const { return is_removed_.has(shape); }
    template <class Contact>
    [[nodiscard]] bool in(const Contact& c) const {
        return any() && (c.count == 0 || has(c.shape_a) || has(c.shape_b));
    }
    /// Takes them out of a list.
    template <class Contact>
    void take_out(buffer<Contact>& contacts) const {
        partition_contacts(
            contacts, [&](const auto& c) { return !in(c); }, [](const auto&) {});
    }
    /// All lists are without them.
    void clear() {
        is_removed_.clear();
        any_contact_ = false;
    }

    PHYSICS_HPP_MEMBERS(is_removed_, any_contact_)

private:
    bit_array is_removed_;
    bool any_contact_ = false;
};

}  // namespace detail

PHYSICS_HPP_END
