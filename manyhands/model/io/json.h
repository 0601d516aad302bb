// JSON texts (RFC 8259), bounded in depth.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace manyhands::io {

/// Thrown for texts that are no JSON, and values that are not what they are asked for.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::map<std::string, Json, std::less<>>;

  Json() = default;
  /// Throws JsonError.
  [[nodiscard]] static Json parse(std::string_view text);

  [[nodiscard]] bool has(std::string_view key) const;
  /// The member of that name; throws JsonError if there is none.
  [[nodiscard]] const Json& operator[](std::string_view key) const;
  [[nodiscard]] const Json& at(std::size_t index) const;  ///< throws JsonError if there is none
  [[nodiscard]] const Array& array() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] std::size_t count() const;  ///< a whole number, 0 to 2^32
  [[nodiscard]] const std::string& text() const;

 private:
  friend class JsonParser;
  std::variant<std::monostate, bool, double, std::string, Array, Object> value_;
};

}  // namespace manyhands::io
