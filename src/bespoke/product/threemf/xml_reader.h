#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "bespoke/product/threemf/zip_file.h"

namespace bespoke {

/// An element as it begins. Names of other namespaces than the document's own are "namespace|name".
class XmlElement {
 public:
  XmlElement(const char* name, const char** attributes) : name_(name), attributes_(attributes) {}

  std::string_view name() const { return name_; }
  /// Null when it is not there.
  const char* attribute(std::string_view name) const;

 private:
  const char* name_;
  const char** attributes_;
};

/// Reads an XML document of a package from its beginning to its end, without keeping it (expat).
class XmlReader {
 public:
  /// `begin` and `end` are called for elements in document order; what they throw reaches the caller of read.
  std::function<void(const XmlElement& element)> begin;
  std::function<void(std::string_view name)> end = [](std::string_view) {};

  /// Throws FormatError naming the entry and the line of what is no XML, and of a document type, which no
  /// package has and which could expand without bound.
  void read(const ZipFile& package, const ZipEntry& entry);

  void stop() { stopped_ = true; }  ///< nothing that follows is needed

  std::size_t line() const { return line_; }
  /// The namespace of a prefix that is in use; empty for others.
  std::string namespace_of(const std::string& prefix) const;
  /// "file: entry:line: what"
  [[noreturn]] void fail(const std::string& what) const;

 private:
  friend struct ExpatHandlers;
  std::map<std::string, std::string> namespaces_;
  std::string place_;
  std::size_t line_ = 1;
  bool stopped_ = false;
};

}  // namespace bespoke
