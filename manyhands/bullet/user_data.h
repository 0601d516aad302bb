// Texts that programs attach to bodies.
#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

namespace manyhands::bullet {

struct UserDataKey {
  int body = -1, link = -1, visual = -1;
  std::string name{};
  auto operator<=>(const UserDataKey&) const = default;
};

class UserData {
 public:
  struct Entry {
    UserDataKey key;
    std::string value;
  };

  /// The id; that of the same key, if there is one.
  int add(const UserDataKey& key, const std::string& value) {
    const int known = find(key);
    const int id = known >= 0 ? known : next_++;
    entries_[id] = {key, value};
    return id;
  }
  [[nodiscard]] const Entry* find(int id) const {
    const auto found = entries_.find(id);
    return found == entries_.end() ? nullptr : &found->second;
  }
  [[nodiscard]] int find(const UserDataKey& key) const {
    for (const auto& [id, entry] : entries_) {
      if (entry.key == key) return id;
    }
    return -1;
  }
  [[nodiscard]] std::vector<int> of_body(int body) const {
    std::vector<int> ids;
    for (const auto& [id, entry] : entries_) {
      if (entry.key.body == body) ids.push_back(id);
    }
    return ids;
  }
  void remove(int id) { entries_.erase(id); }
  void remove_body(int body) {
    std::erase_if(entries_, [&](const auto& entry) { return entry.second.key.body == body; });
  }
  void clear() { *this = {}; }

 private:
  std::map<int, Entry> entries_;
  int next_ = 0;
};

}  // namespace manyhands::bullet
