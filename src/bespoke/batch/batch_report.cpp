#include "bespoke/batch/batch_report.h"

#include <cstdio>

#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

std::string clock_text(double seconds) {
  char text[32];
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld h", whole / 3600, whole / 60 % 60);
  return text;
}

std::string rate_text(double rate) {
  char text[32];
  std::snprintf(text, sizeof text, rate < 0.1 ? "%.3g/min" : "%.3g/s", rate < 0.1 ? 60 * rate : rate);
  return text;
}

}  // namespace

const char* to_string(JobState state) {
  switch (state) {
    case JobState::done:
      return "done";
    case JobState::up_to_date:
      return "up-to-date";
    case JobState::failed:
      return "failed";
    case JobState::not_run:
      return "not-run";
  }
  return "";
}

std::string job_json(const BatchJob& job, const JobForecast& forecast, const JobResult& result) {
  Json json = {{"line", job.line}, {"command", job.command}, {"state", to_string(result.state)}};
  for (const JobFile& output : job.outputs) json["outputs"].push_back(output.path.string());
  if (!result.reason.empty()) json["reason"] = result.reason;
  if (result.threads > 0) {
    json["seconds"] = result.seconds;
    json["threads"] = result.threads;
    json["memory"] = result.memory;
    json["forecast"] = {{"seconds", forecast.seconds}, {"memory", forecast.memory + forecast.shared}};
  }
  if (!result.findings.warnings.empty()) json["warnings"] = result.findings.warnings;
  if (!result.error.empty()) json["error"] = result.error;
  for (const JobFigure& figure : result.findings.figures)
    std::visit([&](const auto& value) { json["figures"][figure.name] = value; }, figure.value);
  return json.dump();
}

BatchProgress::BatchProgress(const std::vector<JobForecast>& forecasts) : forecasts_(forecasts) {
  for (const JobForecast& forecast : forecasts) seconds_total_ += forecast.seconds;
}

void BatchProgress::started(std::size_t) { ++running_; }

void BatchProgress::ended(std::size_t job, const JobResult& result) {
  ++counts_[static_cast<int>(result.state)];
  ++ended_;
  seconds_ended_ += forecasts_[job].seconds;
  if (result.threads == 0) return;
  --running_;
  seconds_run_ += forecasts_[job].seconds;
}

std::size_t BatchProgress::count(JobState state) const { return counts_[static_cast<int>(state)]; }

double BatchProgress::share() const { return seconds_total_ > 0 ? seconds_ended_ / seconds_total_ : 1; }

double BatchProgress::rate() const {
  const std::size_t ran = count(JobState::done) + count(JobState::failed);
  const double seconds = watch_.seconds();
  return seconds > 0 ? static_cast<double>(ran) / seconds : 0;
}

double BatchProgress::seconds_left() const {
  return seconds_run_ > 0 ? watch_.seconds() * (seconds_total_ - seconds_ended_) / seconds_run_ : 0;
}

std::string BatchProgress::line() const {
  std::string text = std::to_string(count(JobState::done)) + " of " + std::to_string(total()) + " done";
  const auto add = [&](std::size_t number, const char* what) {
    if (number > 0) text += ", " + std::to_string(number) + what;
  };
  add(count(JobState::up_to_date), " up to date");
  add(count(JobState::failed), " failed");
  add(running_, " running");
  add(left(), " left");
  if (seconds_run_ > 0) text += ", " + rate_text(rate());
  if (seconds_run_ > 0 && ended_ < total()) text += ", " + clock_text(seconds_left()) + " left";
  return text;
}

}  // namespace bespoke
