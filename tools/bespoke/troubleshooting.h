#pragma once

#include <array>
#include <string>

#include "bespoke/enum_names.h"

namespace bespoke::command {

/// Entries of samples/cookbook/troubleshooting.md that warnings name, so that a user finds what to do there.
enum class Entry {
  anchors_far_away,
  anchors_missed,
  content_left_as_it_is,
  contradicting_anchors,
  maps_of_different_sources,
  not_proved,
  order_of_layers,
  over_stretched,
  parts_far_from_anchors,
  parts_without_counterpart,
  product_inside_the_target,
  source_off_the_target,
  target_uncovered,
  tolerance_missed,
  vertices_missed,
  whole_map_read,
};

/// Each is the link to its heading: a test looks for it.
inline constexpr std::array entries{
    Named<Entry>{"anchors-far-away", Entry::anchors_far_away},
    Named<Entry>{"anchors-missed", Entry::anchors_missed},
    Named<Entry>{"content-left-as-it-is", Entry::content_left_as_it_is},
    Named<Entry>{"contradicting-anchors", Entry::contradicting_anchors},
    Named<Entry>{"maps-of-different-sources", Entry::maps_of_different_sources},
    Named<Entry>{"not-proved", Entry::not_proved},
    Named<Entry>{"order-of-layers", Entry::order_of_layers},
    Named<Entry>{"over-stretched", Entry::over_stretched},
    Named<Entry>{"parts-far-from-anchors", Entry::parts_far_from_anchors},
    Named<Entry>{"parts-without-counterpart", Entry::parts_without_counterpart},
    Named<Entry>{"product-inside-the-target", Entry::product_inside_the_target},
    Named<Entry>{"source-off-the-target", Entry::source_off_the_target},
    Named<Entry>{"target-uncovered", Entry::target_uncovered},
    Named<Entry>{"tolerance-missed", Entry::tolerance_missed},
    Named<Entry>{"vertices-missed", Entry::vertices_missed},
    Named<Entry>{"whole-map-read", Entry::whole_map_read}};

/// The warning with its entry at the end: "… (see troubleshooting.md#not-proved)".
inline std::string with_entry(const std::string& warning, Entry entry) {
  return warning + " (see troubleshooting.md#" + std::string(name_of(entries, entry)) + ")";
}

}  // namespace bespoke::command
