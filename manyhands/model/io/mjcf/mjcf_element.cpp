#include "manyhands/model/io/mjcf/mjcf_element.h"

#include <algorithm>
#include <cmath>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr double kLargest = 1e12;

template <class List>
bool is_listed(const List& list, std::string_view name) {
  return std::ranges::find(list, name) != list.end();
}

}  // namespace

MjcfElement MjcfElement::named(std::string what) const {
  MjcfElement result = *this;
  result.what_ = std::move(what);
  return result;
}

MjcfElement MjcfElement::with_suffix(const std::string& suffix) const {
  MjcfElement result = *this;
  result.suffix_ = suffix + suffix_;
  return result;
}

MjcfElement MjcfElement::with_defaults(const MjcfClasses& classes, std::string_view kind) const {
  const bool has_class = has_own("class");
  const std::string name = has_class             ? node_.attribute("class").value()
                           : childclass_.empty() ? source_->models()[model()].main_class
                                                 : childclass_;
  const auto found = classes.by_name.find(name);
  if (found == classes.by_name.end()) {
    if (name == source_->models()[model()].main_class) return *this;
    fail("there is no default class " + in_quotes(name) + "; expected the class of a <default>");
  }
  MjcfElement result = *this;
  const auto values = found->second.values.find(kind);
  if (values != found->second.values.end()) result.defaults_ = &values->second;
  return result;
}

std::vector<MjcfElement> MjcfElement::children() const {
  std::vector<MjcfElement> found;
  add_children(*file_, node_, found);
  return found;
}

void MjcfElement::add_children(const MjcfFile& file, const pugi::xml_node& node,
                               std::vector<MjcfElement>& found) const {
  const char* const childclass = node_.attribute("childclass").value();
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    if (std::string_view(child.name()) == "include") {
      const MjcfFile& other = source_->included(child);
      add_children(other, other.xml.root(), found);
      continue;
    }
    if (std::string_view(child.name()) == "attach") {
      add_attached(child, found);
      continue;
    }
    MjcfElement& added = found.emplace_back(*source_, file, child, what_);
    added.suffix_ = suffix_;
    added.childclass_ = *childclass != '\0' ? std::string(childclass) : childclass_;
  }
}

std::optional<MjcfElement> MjcfElement::find_body(const std::string& name) const {
  for (const MjcfElement& child : children()) {
    if (child.tag() == "body" && child.node_.attribute("name").value() == name) return child;
    if (std::optional<MjcfElement> found = child.find_body(name)) return found;
  }
  return std::nullopt;
}

void MjcfElement::add_attached(const pugi::xml_node& attach, std::vector<MjcfElement>& found) const {
  const MjcfModel& model = source_->attached(attach);
  const std::size_t first = found.size();
  for (const MjcfElement& world :
       MjcfElement(*source_, *model.root, model.root->xml.root(), what_).children("worldbody")) {
    if (model.target.empty()) {
      for (const MjcfElement& element : world.children()) found.push_back(element);
    } else if (const auto body = world.find_body(model.target); body && found.size() == first) {
      found.push_back(*body);
    }
  }
  if (!model.target.empty() && found.size() == first) {
    throw MjcfError(file_->name, file_->xml.line(attach),
                    "<attach>: there is no body " + in_quotes(attach.attribute("body").value()) + " in " +
                        in_quotes(model.root->name) + "; expected the name of one");
  }
  for (std::size_t i = first; i < found.size(); ++i) found[i].suffix_ = suffix_;
}

std::vector<MjcfElement> MjcfElement::children(std::string_view tag) const {
  std::vector<MjcfElement> found = children();
  std::erase_if(found, [&](const MjcfElement& child) { return child.tag() != tag; });
  return found;
}

std::vector<std::pair<std::string, std::string>> MjcfElement::own_attributes() const {
  std::vector<std::pair<std::string, std::string>> found;
  for (const pugi::xml_attribute& attribute : node_.attributes())
    found.emplace_back(attribute.name(), attribute.value());
  return found;
}

std::optional<std::string_view> MjcfElement::find(const char* attribute) const {
  if (const pugi::xml_attribute own = node_.attribute(attribute)) return own.value();
  if (defaults_ == nullptr) return std::nullopt;
  const auto found = defaults_->find(attribute);
  return found == defaults_->end() ? std::nullopt : std::optional<std::string_view>(found->second);
}

std::string MjcfElement::holds(const char* attribute) const {
  return "attribute '" + std::string(attribute) + "' of <" + std::string(tag()) + "> holds " +
         in_quotes(find(attribute).value_or("")) + (has_own(attribute) ? "" : ", by its default class");
}

std::string MjcfElement::text_or(const char* attribute, const std::string& fallback) const {
  const auto found = find(attribute);
  if (!found) return fallback;
  const bool is_name = std::string_view(attribute) == "name" && !found->empty();
  return is_name ? std::string(*found) + suffix_ : std::string(*found);
}

std::string MjcfElement::text(const char* attribute) const {
  const auto found = find(attribute);
  const std::string name = "attribute '" + std::string(attribute) + "' of <" + std::string(tag()) + ">";
  if (!found) fail(name + " is missing");
  if (found->empty()) fail(name + " is empty");
  return std::string(*found);
}

std::vector<double> MjcfElement::numbers(const char* attribute, std::size_t fewest, std::size_t most) const {
  const auto found = find(attribute);
  if (!found) return {};
  const auto expected = [&] {
    const std::string count = std::to_string(fewest) + (fewest == most ? "" : " to " + std::to_string(most));
    return most == 1 ? std::string("; expected one finite number")
                     : "; expected " + count + " finite numbers between blanks";
  };
  std::vector<std::string_view> parts = split_blanks(*found);
  if (has_own(attribute) && defaults_ != nullptr && defaults_->contains(attribute)) {
    const std::vector<std::string_view> of_class = split_blanks(defaults_->find(attribute)->second);
    if (of_class.size() > parts.size()) {
      parts.insert(parts.end(), of_class.begin() + std::ssize(parts), of_class.end());
    }
  }
  if (parts.size() < fewest || parts.size() > most) fail(holds(attribute) + expected());
  std::vector<double> result;
  for (const std::string_view part : parts) {
    const std::optional<double> number = parse_number(part);
    if (!number) fail(holds(attribute) + expected());
    if (std::abs(*number) > kLargest) fail(holds(attribute) + "; expected at most 1e12");
    result.push_back(*number);
  }
  return result;
}

std::optional<double> MjcfElement::optional_number(const char* attribute) const {
  return has(attribute) ? std::optional(numbers(attribute, 1, 1)[0]) : std::nullopt;
}

double MjcfElement::number_or(const char* attribute, double fallback) const {
  return optional_number(attribute).value_or(fallback);
}

double MjcfElement::positive_or(const char* attribute, double fallback) const {
  const double value = number_or(attribute, fallback);
  if (value < 0) fail(holds(attribute) + "; expected 0 or more");
  return value;
}

int MjcfElement::integer_or(const char* attribute, int fallback) const {
  const double value = number_or(attribute, fallback);
  if (value != std::round(value) || std::abs(value) > 2147483647.0)
    fail(holds(attribute) + "; expected a whole number");
  return static_cast<int>(value);
}

bool MjcfElement::boolean_or(const char* attribute, bool fallback) const {
  return word_or(attribute, {"true", "false"}, fallback ? "true" : "false") == "true";
}

Vec3<double> MjcfElement::vec3_or(const char* attribute, const Vec3<double>& fallback) const {
  if (!has(attribute)) return fallback;
  const std::vector<double> v = numbers(attribute, 3, 3);
  return {v[0], v[1], v[2]};
}

std::string MjcfElement::word_or(const char* attribute, std::initializer_list<std::string_view> words,
                                 const std::string& fallback) const {
  const auto found = find(attribute);
  if (!found) return fallback;
  if (is_listed(words, *found)) return std::string(*found);
  std::string known;
  for (const std::string_view word : words) known += (known.empty() ? "" : ", ") + std::string(word);
  fail(holds(attribute) + "; expected one of " + known);
}

void MjcfElement::expect(std::initializer_list<std::string_view> attributes,
                         std::span<const std::string_view> child_tags) const {
  const std::string own_tag = "<" + std::string(tag()) + ">";
  for (const pugi::xml_attribute& attribute : node_.attributes()) {
    const std::string_view name = attribute.name();
    if (is_listed(attributes, name)) continue;
    note_once(own_tag + " " + std::string(name), LoadAction::kIgnored,
              "attribute " + in_quotes(name) + " of " + own_tag + " is not used");
  }
  for (const MjcfElement& child : children()) {
    if (is_listed(child_tags, child.tag())) continue;
    const std::string child_tag = "<" + std::string(child.tag()) + ">";
    child.note_once(own_tag + child_tag, LoadAction::kIgnored, child_tag + " in " + own_tag + " is not used");
  }
}

void MjcfElement::ignore(std::initializer_list<const char*> attributes) const {
  for (const char* const attribute : attributes) {
    if (!has(attribute)) continue;
    const std::string own_tag = "<" + std::string(tag()) + ">";
    note_once(own_tag + " " + attribute, LoadAction::kIgnored,
              "attribute '" + std::string(attribute) + "' of " + own_tag + " is not used");
  }
}

void MjcfElement::fail(const std::string& message) const {
  throw MjcfError(file_->name, line(), what_ + ": " + message);
}

void MjcfElement::note(LoadAction action, std::string message) const {
  source_->note({action, file_->name, line(), what_, std::move(message)});
}

void MjcfElement::note_serious(LoadAction action, std::string message) const {
  source_->note({action, file_->name, line(), what_, std::move(message), true});
}

void MjcfElement::note_once(const std::string& key, LoadAction action, std::string message) const {
  source_->note_once(key, {action, file_->name, line(), what_, std::move(message)});
}

}  // namespace manyhands::io
