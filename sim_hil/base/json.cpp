#include "json.h"

#include <stdexcept>

#include <nlohmann/json.hpp>

namespace quiesce {

using Tree = nlohmann::ordered_json;

Json::Json() : tree_(std::make_unique<Tree>()) {}
Json::Json(std::nullptr_t) : Json() {}
Json::Json(bool value) : tree_(std::make_unique<Tree>(value)) {}
Json::Json(double value) : tree_(std::make_unique<Tree>(value)) {}
Json::Json(const char *text) : tree_(std::make_unique<Tree>(text)) {}
Json::Json(const std::string &text) : tree_(std::make_unique<Tree>(text)) {}
Json::Json(Whole<true> whole) : tree_(std::make_unique<Tree>(whole.value)) {}
Json::Json(Whole<false> whole) : tree_(std::make_unique<Tree>(whole.value)) {}

Json::Json(std::initializer_list<Member> members) : Json(object()) {
    for (const auto &[name, value] : members) {
        set(name, value);
    }
}

Json::Json(const Json &other) : tree_(std::make_unique<Tree>(*other.tree_)) {}
Json::Json(Json &&other) noexcept = default;
Json::~Json() = default;

Json &Json::operator=(Json other) noexcept {
    tree_.swap(other.tree_);
    return *this;
}

Json Json::array() {
    Json out;
    *out.tree_ = Tree::array();
    return out;
}

Json Json::object() {
    Json out;
    *out.tree_ = Tree::object();
    return out;
}

void Json::push_back(const Json &value) {
    tree_->push_back(*value.tree_);
}

void Json::set(const std::string &name, const Json &value) {
    (*tree_)[name] = *value.tree_;
}

Json Json::at(const std::string &name) const {
    const auto found = tree_->find(name);
    if (found == tree_->end()) {
        throw std::out_of_range("no member '" + name + "'");
    }
    Json out;
    *out.tree_ = *found;
    return out;
}

std::string Json::dump(int indent) const {
    return tree_->dump(indent);
}

} // namespace quiesce
