#pragma once

#include <string>
#include <vector>

#include "bespoke/page/view_scene.h"

namespace bespoke {

struct ReportPicture {
  std::string name;     ///< for a file, without directory or ending
  std::string caption;  ///< what it shows, with the range of its colours
  std::string png;      ///< bytes of the file
};

/// A map as something to send: pictures, tables, places worth a look.
struct MapReport {
  std::string title;
  std::string command;
  std::vector<ReportPicture> pictures;
  std::string quality;  ///< lines of `measure`
  std::string places;   ///< a line each, empty without any
  std::string info;     ///< lines of `info`
};

/// Draws source and target with what they wear, from the front and from the side. Throws as view_scene.
MapReport map_report(const ViewInput& input, const Progress& progress = {});

/// As Markdown that names the pictures as files of `pictures_prefix` + name + ".png" beside it.
std::string report_markdown(const MapReport& report, const std::string& pictures_prefix);

/// As one HTML file with the pictures inside.
std::string report_html(const MapReport& report);

}  // namespace bespoke
