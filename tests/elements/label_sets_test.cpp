#include "underbrush/elements/label_sets.hpp"

#include <gtest/gtest.h>

#include <set>

#include "underbrush/elements/classes.hpp"

namespace underbrush::elements {
namespace {

TEST(LabelSets, NumbersAndNamesAreUnique) {
  for (const std::string& set : label_set_names()) {
    std::set<uint32_t> numbers;
    std::set<std::string_view> names;
    for (const Label& label : labels_of(set)) {
      EXPECT_TRUE(numbers.insert(label.number).second) << set << " " << label.number;
      EXPECT_TRUE(names.insert(label.name).second) << set << " " << label.name;
    }
    EXPECT_GE(numbers.size(), 10u) << set;
  }
  EXPECT_TRUE(labels_of("").empty());
}

TEST(LabelSets, OursAreTheClasses) {
  for (uint32_t k = 0; k < kClassNames.size(); ++k) {
    EXPECT_EQ(label_name("underbrush", k), kClassNames[k]);
  }
  EXPECT_EQ(ground_label("underbrush", uint32_t(Class::kGround)), GroundLabel::kYes);
  EXPECT_EQ(ground_label("underbrush", uint32_t(Class::kLowShrub)), GroundLabel::kNo);
  EXPECT_EQ(ground_label("underbrush", uint32_t(Class::kUnknown)), GroundLabel::kUnknown);
}

TEST(LabelSets, WhatASetDoesNotHaveIsItsNumberAndUnknown) {
  EXPECT_EQ(label_name("semantickitti", 70), "vegetation");
  EXPECT_EQ(label_name("semantickitti", 12345), "12345");
  EXPECT_EQ(label_name("", 70), "70");
  EXPECT_EQ(ground_label("semantickitti", 12345), GroundLabel::kUnknown);
  EXPECT_EQ(ground_label("rellis", 3), GroundLabel::kYes);
}

}  // namespace
}  // namespace underbrush::elements
