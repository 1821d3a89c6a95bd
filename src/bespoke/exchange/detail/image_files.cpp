#include "bespoke/exchange/detail/image_files.h"

#include <bit>
#include <cstdint>
#include <ostream>

#include "bespoke/number_format.h"

namespace bespoke {
namespace {

static_assert(std::endian::native == std::endian::little, "the headers below say so");

std::string number(double value) { return format_number(value, 17); }

std::string numbers(const Vector3& v) { return number(v.x()) + " " + number(v.y()) + " " + number(v.z()); }

std::string in_parentheses(const Vector3& v) {
  return std::string("(") + number(v.x()) + "," + number(v.y()) + "," + number(v.z()) + ")";
}

void write_values(std::ostream& out, const std::vector<float>& values) {
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(float)));
}

}  // namespace

// Scalars too, because vtkGridTransform requires scalars of three components; other filters require vectors.
void write_vti(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes) {
  std::string extent;
  for (const std::size_t size : image.size)
    extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(size - 1);
  const std::uint64_t bytes = image.values.size() * sizeof(float);
  out << "<?xml version=\"1.0\"?>\n<!-- " << notes.content << " -->\n"
      << "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      << "<ImageData WholeExtent=\"" << extent << "\" Origin=\"" << numbers(image.origin) << "\" Spacing=\""
      << numbers(Vector3::Constant(image.spacing)) << "\">\n<Piece Extent=\"" << extent
      << "\"><PointData Scalars=\"displacement\" Vectors=\"displacement\">\n<DataArray type=\"Float32\" "
         "Name=\"displacement\" "
         "NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>\n"
      << "</PointData></Piece></ImageData>\n<AppendedData encoding=\"raw\">_";
  out.write(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  write_values(out, image.values);
  out << "</AppendedData>\n</VTKFile>\n";
}

void write_nrrd(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes) {
  // From RAS to LPS x and y change their signs: of the places by their origin and steps, of the vectors one
  // by one.
  const double sign = notes.space == WorldSpace::ras ? -1 : 1;
  const Vector3 turned(sign, sign, 1);
  out << "NRRD0005\n# " << notes.content
      << "\ntype: float\ndimension: 4\nspace: left-posterior-superior\nsizes: 3";
  for (const std::size_t size : image.size) out << ' ' << size;
  out << "\nspace directions: none";
  for (int axis = 0; axis < 3; ++axis)
    out << ' ' << in_parentheses(image.spacing * turned(axis) * Vector3::Unit(axis));
  out << "\nkinds: vector domain domain domain\nendian: little\nencoding: raw\nspace origin: "
      << in_parentheses(turned.cwiseProduct(image.origin)) << "\n\n";
  std::vector<float> values = image.values;
  if (sign < 0)
    for (std::size_t n = 0; n < values.size(); ++n)
      if (n % 3 < 2) values[n] = -values[n];
  write_values(out, values);
}

}  // namespace bespoke
