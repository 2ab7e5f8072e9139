// The state of a run as bytes, so that the run can be interrupted and continued later with bitwise
// equal results.
//
// One function of a class lists the parts of its state, for storing and restoring:
//   void Walk::keep(Snapshot& snapshot) { snapshot(steps_, where_m_, path_m_); }
// Values that follow from the run's inputs are recomputed instead of stored.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace photorque {

class Snapshot;

template <class T>
concept HasState = requires(T& value, Snapshot& snapshot) {
  value.keep(snapshot);
};
// Numbers, and vectors and structs of numbers, which can be copied as bytes. (Eigen's vectors can,
// although they are not trivially copyable.)
template <class T>
concept MadeOfNumbers =
    std::is_trivially_destructible_v<T> && !std::is_pointer_v<T> && !HasState<T>;

class Snapshot {
 public:
  // Stores a state.
  Snapshot() = default;
  // Restores the state from `bytes`, which must outlive it.
  explicit Snapshot(const std::string& bytes) : source_(&bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (value(values), ...);
  }
  // A list; `visit` processes each element.
  template <class List, class Visit>
  void each(List& list, const Visit& visit) {
    uint64_t count = list.size();
    value(count);
    if (is_restoring_state()) list.clear();
    for (uint64_t i = 0; i < count && good_; ++i) {
      if (is_restoring_state()) list.emplace_back();
      visit(list[i]);
    }
  }
  // A list of numbers whose length is known.
  template <MadeOfNumbers T>
  void fixed(std::vector<T>& list) {
    expect(list.size());
    copy(reinterpret_cast<char*>(list.data()), list.size() * sizeof(T));
  }
  // A number that follows from the inputs. A state with a different number belongs to another run.
  void expect(uint64_t number) {
    uint64_t kept = number;
    value(kept);
    good_ = good_ && kept == number;
  }
  // A count or an index of at most `largest`.
  template <class Integer>
  void at_most(Integer& number, uint64_t largest) {
    value(number);
    good_ = good_ && number >= 0 && static_cast<uint64_t>(number) <= largest;
    if (!good_) number = 0;
  }

  bool is_restoring_state() const { return source_ != nullptr; }
  // Whether the whole state was restored and no bytes remain. Otherwise the values are invalid.
  bool is_whole() const { return good_ && (!is_restoring_state() || at_ == source_->size()); }
  // The bytes written so far.
  const std::string& bytes() const { return taken_; }

 private:
  template <MadeOfNumbers T>
  void value(T& numbers) {
    copy(reinterpret_cast<char*>(&numbers), sizeof numbers);
  }
  template <HasState T>
  void value(T& part) {
    part.keep(*this);
  }
  void value(bool& truth) {
    char byte = truth ? 1 : 0;
    copy(&byte, 1);
    truth = byte != 0;
  }
  void value(std::string& text) { block(text); }
  template <MadeOfNumbers T>
  void value(std::vector<T>& numbers) {
    block(numbers);
  }
  template <class T>
  void value(std::optional<T>& perhaps) {
    bool is_there = perhaps.has_value();
    value(is_there);
    if (is_restoring_state()) perhaps = is_there ? std::optional<T>(T{}) : std::nullopt;
    if (is_there) value(*perhaps);
  }
  template <class Block>
  void block(Block& numbers) {
    uint64_t count = numbers.size();
    value(count);
    constexpr size_t each_bytes = sizeof(typename Block::value_type);
    if (is_restoring_state()) {
      // The count must not exceed the number of remaining bytes.
      good_ = good_ && count <= (source_->size() - at_) / each_bytes;
      numbers.resize(good_ ? count : 0);
    }
    copy(reinterpret_cast<char*>(numbers.data()), numbers.size() * each_bytes);
  }
  void copy(char* numbers, size_t bytes) {
    if (!is_restoring_state()) {
      taken_.append(numbers, bytes);
      return;
    }
    good_ = good_ && bytes <= source_->size() - at_;
    if (!good_) return;
    std::copy_n(source_->data() + at_, bytes, numbers);
    at_ += bytes;
  }

  const std::string* source_ = nullptr;
  std::string taken_;
  size_t at_ = 0;
  bool good_ = true;
};

}  // namespace photorque
