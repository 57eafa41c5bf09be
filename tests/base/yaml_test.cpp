// SPDX-License-Identifier: BSD-3-Clause
#include "base/yaml.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"

namespace grouser {
namespace {

TEST(Yaml, RemembersWhereAValueWasWritten) {
  const YamlNode node = parse_yaml("a: 1\nb:\n  c: two\n", "f.yaml");
  const YamlNode* c = node.find("b")->find("c");
  EXPECT_EQ(c->scalar, "two");
  EXPECT_EQ(c->line, 3);
  EXPECT_EQ(c->column, 6);
}

TEST(Yaml, RefusesAKeyGivenTwice) {
  try {
    parse_yaml("a: 1\na: 2\n", "f.yaml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "f.yaml:2:1: a: given twice; first given in line 1");
  }
}

TEST(Yaml, RefusesDocumentsThatUnfoldWithoutEnd) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string one = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + one;
    for (int k = 0; k < 9; ++k) bomb += ", " + one;
    bomb += "]\n";
  }
  EXPECT_THROW(parse_yaml(bomb, "bomb.yaml"), ConfigError);
}

TEST(Yaml, RefusesASecondDocument) {
  try {
    parse_yaml("a: 1\n---\nb: 2\n", "two.yaml");
    ADD_FAILURE() << "the second document was ignored";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("two.yaml:2:1: a second document"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(parse_yaml("---\na: 1\n", "one.yaml").entries.size(), 1u);
}

// The library's reader of several documents never ends on these.
TEST(Yaml, RefusesATextThatBeginsWithAComma) {
  for (const char* text : {",x", ", a: 1", ",\xff\xff", "}", "]"})
    EXPECT_THROW(parse_yaml(text, "comma.yaml"), ConfigError) << text;
}

TEST(Yaml, SyntaxErrorsNameTheLine) {
  try {
    parse_yaml("a: [1, 2\nb: 3\n", "f.yaml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("f.yaml:2"), std::string::npos) << error.what();
  }
}

TEST(Yaml, OverlayMakesTheMapsOnItsWay) {
  YamlNode node = parse_yaml("a: {b: 1}\n", "f");
  node.overlay("a.c.d", YamlNode::make_scalar("2"));
  node.overlay("a.b", YamlNode::make_scalar("3"));
  EXPECT_EQ(node.find("a")->find("c")->find("d")->scalar, "2");
  EXPECT_EQ(node.find("a")->find("b")->scalar, "3");
  EXPECT_THROW(node.overlay("a.b.x", YamlNode::make_scalar("4")), std::invalid_argument);
}

TEST(Yaml, EmittedTextReadsBackTheSame) {
  YamlNode node = YamlNode::make_map();
  for (const char* text : {"plain", "true", "12", "a: b", "line\nbreak", "", "- x", "'q'"})
    node.entries.emplace_back("k" + std::to_string(node.entries.size()),
                              YamlNode::make_scalar(text));
  const YamlNode back = parse_yaml(emit_yaml(node), "f");
  ASSERT_EQ(back.entries.size(), node.entries.size());
  for (std::size_t i = 0; i < node.entries.size(); ++i)
    EXPECT_EQ(back.entries[i].second.scalar, node.entries[i].second.scalar);
}

}  // namespace
}  // namespace grouser
