#include "manyhands/model/io/json.h"

#include <cmath>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

class JsonParser {
 public:
  explicit JsonParser(std::string_view text) : rest_(text) {}

  Json whole() {
    Json result = value(0);
    skip_blanks();
    if (!rest_.empty()) throw JsonError("there is more behind the JSON text");
    return result;
  }

 private:
  static constexpr int kMostDepth = 64;

  void skip_blanks() {
    const std::size_t end = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(end == rest_.npos ? rest_.size() : end);
  }

  bool take(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  void expect(std::string_view word) {
    skip_blanks();
    if (!take(word)) throw JsonError("expected '" + std::string(word) + "' before " + in_quotes(rest_.substr(0, 20)));
  }

  Json value(int depth) {
    if (depth > kMostDepth) throw JsonError("JSON nested more than 64 deep");
    skip_blanks();
    Json result;
    if (take("{")) {
      result.value_ = object(depth);
    } else if (take("[")) {
      result.value_ = array(depth);
    } else if (rest_.starts_with('"')) {
      result.value_ = string();
    } else if (take("true")) {
      result.value_ = true;
    } else if (take("false")) {
      result.value_ = false;
    } else if (!take("null")) {
      result.value_ = number();
    }
    return result;
  }

  Json::Object object(int depth) {
    Json::Object members;
    skip_blanks();
    if (take("}")) return members;
    do {
      skip_blanks();
      std::string key = string();
      expect(":");
      members.insert_or_assign(std::move(key), value(depth + 1));
      skip_blanks();
    } while (take(","));
    expect("}");
    return members;
  }

  Json::Array array(int depth) {
    Json::Array items;
    skip_blanks();
    if (take("]")) return items;
    do {
      items.push_back(value(depth + 1));
      skip_blanks();
    } while (take(","));
    expect("]");
    return items;
  }

  /// Escapes of code points become '?': names of files and parts that need them are not read here.
  std::string string() {
    expect("\"");
    std::string text;
    while (!rest_.empty() && rest_.front() != '"') {
      char c = rest_.front();
      rest_.remove_prefix(1);
      if (c == '\\') {
        if (rest_.empty()) break;
        c = rest_.front();
        rest_.remove_prefix(1);
        if (c == 'u') {
          rest_.remove_prefix(std::min<std::size_t>(4, rest_.size()));
          c = '?';
        } else if (c == 'n' || c == 't' || c == 'r' || c == 'b' || c == 'f') {
          c = ' ';
        }
      }
      text += c;
    }
    expect("\"");
    return text;
  }

  double number() {
    const std::string_view digits = rest_.substr(0, rest_.find_first_not_of("+-.eE0123456789"));
    const std::optional<double> value = parse_number(digits);
    if (!value) throw JsonError("expected a value before " + in_quotes(rest_.substr(0, 20)));
    rest_.remove_prefix(digits.size());
    return *value;
  }

  std::string_view rest_;
};

Json Json::parse(std::string_view text) { return JsonParser(text).whole(); }

bool Json::has(std::string_view key) const {
  const Object* const object = std::get_if<Object>(&value_);
  return object != nullptr && object->contains(key);
}

const Json& Json::operator[](std::string_view key) const {
  if (!has(key)) throw JsonError("there is no \"" + std::string(key) + "\"");
  return std::get<Object>(value_).find(key)->second;
}

const Json& Json::at(std::size_t index) const {
  if (index >= array().size()) throw JsonError("there is no item " + std::to_string(index));
  return array()[index];
}

const Json::Array& Json::array() const {
  if (const Array* const items = std::get_if<Array>(&value_)) return *items;
  throw JsonError("expected a list");
}

double Json::number() const {
  if (const double* const number = std::get_if<double>(&value_)) return *number;
  throw JsonError("expected a number");
}

std::size_t Json::count() const {
  constexpr double kMost = 4294967296.0;
  const double value = number();
  if (!(value >= 0 && value <= kMost && value == std::floor(value))) throw JsonError("expected a whole number");
  return static_cast<std::size_t>(value);
}

const std::string& Json::text() const {
  if (const std::string* const text = std::get_if<std::string>(&value_)) return *text;
  throw JsonError("expected a text");
}

}  // namespace manyhands::io
