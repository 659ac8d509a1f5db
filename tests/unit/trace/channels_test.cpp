#include "hil/trace/channels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/trace/columns.h"

namespace forcegate {
namespace {

TEST(KnownChannels, HaveOneMeaningForEachWord) {
  std::set<std::string_view> names, words;
  for (const KnownChannel& c : kKnownChannels) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_TRUE(find_unit(c.unit).has_value()) << c.name;
    EXPECT_EQ(find_unit(c.unit)->quantity, c.quantity) << c.name;
    for (const std::string_view word : c.words) {
      if (word.empty()) continue;
      EXPECT_TRUE(words.insert(word).second) << word;
      EXPECT_EQ(word, ascii_lower(word));
      EXPECT_EQ(known_name(word), c.name);
    }
  }
}

TEST(KnownChannels, NoneIsToldAsUnusedAndAnyOtherIs) {
  Trace trace;
  for (const KnownChannel& c : kKnownChannels) {
    Channel channel;
    channel.name = c.name;
    trace.channels.push_back(channel);
  }
  EXPECT_TRUE(unused_columns(trace).empty());
  trace.channels.emplace_back().name = "strain";
  EXPECT_EQ(unused_columns(trace), std::vector<std::string>{"strain"});
}

TEST(KnownChannels, AreThoseOfThePage) {
  const auto page = read_file(FORCEGATE_SOURCE_DIR "/docs/campaign.md");
  ASSERT_TRUE(page) << page.error().to_text();
  const std::size_t from = page->find("| column | meaning | needed |"), to = page->find("\n\n", from);
  ASSERT_NE(from, std::string::npos);
  const std::string table = page->substr(from, to - from);
  for (const KnownChannel& c : kKnownChannels) {
    const std::string header = header_of(c.name, c.unit);
    const bool told = table.find("\n| `" + header + "` |") != std::string::npos || table.find("`" + std::string(c.name) + "`") != std::string::npos;
    EXPECT_TRUE(told) << header << " is not in the table of docs/campaign.md";
  }
}

TEST(KnownChannels, OnlyOneOfAQuantityStandsForItAlone) {
  std::set<std::string_view> alone;
  for (const KnownChannel& c : kKnownChannels)
    if (c.stands_alone) {
      EXPECT_TRUE(alone.insert(c.quantity).second) << c.name;
    }
  EXPECT_EQ(std::ranges::count_if(kKnownChannels, &KnownChannel::is_cause), 3);
}

}  // namespace
}  // namespace forcegate
