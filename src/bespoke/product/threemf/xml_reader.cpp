#include "bespoke/product/threemf/xml_reader.h"

#include <expat.h>

#include <exception>
#include <memory>
#include <new>

#include "bespoke/error.h"

namespace bespoke {

/// What expat calls. Its C code must not see exceptions, so they wait until it has returned.
struct ExpatHandlers {
  XmlReader& reader;
  XML_Parser parser;
  std::exception_ptr thrown = nullptr;

  template <class Action>
  static void guarded(void* data, const Action& action) {
    auto& self = *static_cast<ExpatHandlers*>(data);
    if (self.thrown || self.reader.stopped_) return;
    self.reader.line_ = XML_GetCurrentLineNumber(self.parser);
    try {
      action(self.reader);
    } catch (...) {
      self.thrown = std::current_exception();
    }
    if (self.thrown || self.reader.stopped_) XML_StopParser(self.parser, XML_FALSE);
  }

  static void XMLCALL begin(void* data, const XML_Char* name, const XML_Char** attributes) {
    guarded(data, [&](XmlReader& reader) { reader.begin(XmlElement(name, attributes)); });
  }
  static void XMLCALL end(void* data, const XML_Char* name) {
    guarded(data, [&](XmlReader& reader) { reader.end(name); });
  }
  static void XMLCALL declare(void* data, const XML_Char* prefix, const XML_Char* uri) {
    guarded(data, [&](XmlReader& reader) { reader.namespaces_[prefix ? prefix : ""] = uri ? uri : ""; });
  }
  static void XMLCALL refuse(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    guarded(data,
            [](XmlReader& reader) { reader.fail("has a document type, which a package must not have"); });
  }
};

const char* XmlElement::attribute(std::string_view name) const {
  for (const char** at = attributes_; *at; at += 2)
    if (name == *at) return at[1];
  return nullptr;
}

void XmlReader::read(const ZipFile& package, const ZipEntry& entry) {
  place_ = package.path().string() + ": " + entry.name;
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreateNS(nullptr, '|'),
                                                                            &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  ExpatHandlers handlers{*this, parser.get()};
  XML_SetUserData(parser.get(), &handlers);
  XML_SetElementHandler(parser.get(), ExpatHandlers::begin, ExpatHandlers::end);
  XML_SetStartNamespaceDeclHandler(parser.get(), ExpatHandlers::declare);
  XML_SetStartDoctypeDeclHandler(parser.get(), ExpatHandlers::refuse);
  const auto parse = [&](std::string_view piece, bool is_last) {
    const XML_Status status =
        XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()), is_last ? 1 : 0);
    if (handlers.thrown) std::rethrow_exception(handlers.thrown);
    if (stopped_) return false;
    line_ = XML_GetCurrentLineNumber(parser.get());
    if (status != XML_STATUS_OK)
      fail(std::string("is no XML: ") + XML_ErrorString(XML_GetErrorCode(parser.get())));
    return true;
  };
  package.read(entry, [&](std::string_view piece) { return parse(piece, false); });
  if (!stopped_) parse("", true);
}

std::string XmlReader::namespace_of(const std::string& prefix) const {
  const auto at = namespaces_.find(prefix);
  return at == namespaces_.end() ? "" : at->second;
}

void XmlReader::fail(const std::string& what) const {
  throw FormatError(place_ + ":" + std::to_string(line_) + ": " + what);
}

}  // namespace bespoke
