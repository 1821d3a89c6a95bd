// What ITK makes of a displacement image, at places of its own choice in it:
//   itk_displacements move|resample IMAGE lps|ras PLACES.obj FOUND.obj
// `move` takes the places through ITK's displacement field transform; `resample` resamples an image whose
// values are its places through it. Both files are in the models' frame, lps or ras; ITK's own is LPS.
#include <itkDisplacementFieldTransform.h>
#include <itkImageFileReader.h>
#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkImageRegionIterator.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkResampleImageFilter.h>
#include <itkVersion.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>

namespace {

using Field = itk::Image<itk::Vector<double, 3>, 3>;
using Transform = itk::DisplacementFieldTransform<double, 3>;
using Place = Field::PointType;

constexpr bool knows_displacement_intent = ITK_VERSION_MAJOR > 5 ||
                                           (ITK_VERSION_MAJOR == 5 && ITK_VERSION_MINOR >= 4);
constexpr itk::SizeValueType cells_between_places = 2;

Field::Pointer read(const std::string& name, itk::ImageIOBase* format) {
  const auto reader = itk::ImageFileReader<Field>::New();
  reader->SetImageIO(format);
  reader->SetFileName(name);
  reader->Update();
  if (format->GetNumberOfComponents() != 3)
    throw std::runtime_error(name + ": read with " + std::to_string(format->GetNumberOfComponents()) +
                             " components");
  return reader->GetOutput();
}

/// The file as one of vectors of any meaning, which older versions read too, but do not turn from RAS to LPS.
std::string as_any_vectors(const std::string& name) {
  constexpr std::size_t intent = 68;  // offset in the header
  constexpr std::int16_t any_vectors = 1007;
  std::string bytes;
  const gzFile file = gzopen(name.c_str(), "rb");
  char part[1 << 16];
  for (int count = 0; (count = gzread(file, part, sizeof part)) > 0;)
    bytes.append(part, static_cast<std::size_t>(count));
  gzclose(file);
  std::memcpy(bytes.data() + intent, &any_vectors, sizeof any_vectors);
  const std::string copy = name + ".vectors.nii";
  std::ofstream(copy, std::ios::binary) << bytes;
  return copy;
}

Field::Pointer read_displacements(const std::string& name) {
  if (name.ends_with(".nrrd")) return read(name, itk::NrrdImageIO::New());
  if (knows_displacement_intent) return read(name, itk::NiftiImageIO::New());
  const Field::Pointer field = read(as_any_vectors(name), itk::NiftiImageIO::New());
  for (itk::ImageRegionIterator<Field> at(field, field->GetBufferedRegion()); !at.IsAtEnd(); ++at) {
    Field::PixelType turned = at.Get();
    turned[0] = -turned[0];
    turned[1] = -turned[1];
    at.Set(turned);
  }
  return field;
}

/// An image without values whose nodes lie in the middles of cells of the field.
Field::Pointer places_in(const Field& field) {
  itk::ContinuousIndex<double, 3> first;
  first.Fill(0.5);
  Place origin;
  field.TransformContinuousIndexToPhysicalPoint(first, origin);
  Field::SizeType size = field.GetLargestPossibleRegion().GetSize();
  for (unsigned axis = 0; axis < 3; ++axis) size[axis] = (size[axis] - 2) / cells_between_places + 1;
  const auto places = Field::New();
  places->SetRegions(size);
  places->SetOrigin(origin);
  places->SetSpacing(field.GetSpacing() * static_cast<double>(cells_between_places));
  places->SetDirection(field.GetDirection());
  return places;
}

/// An image around everything that the field may lead to, with its places as values, linear between them.
Field::Pointer image_of_places(const Field& field) {
  double reach = 0;
  for (itk::ImageRegionConstIteratorWithIndex<Field> at(&field, field.GetBufferedRegion()); !at.IsAtEnd();
       ++at) {
    Place place;
    field.TransformIndexToPhysicalPoint(at.GetIndex(), place);
    reach = std::max(reach, place.GetVectorFromOrigin().GetNorm() + at.Get().GetNorm());
  }
  const auto image = Field::New();
  image->SetRegions(Field::SizeType{{2, 2, 2}});
  image->SetOrigin(Place(-reach));
  image->SetSpacing(Field::SpacingType(2 * reach));
  image->Allocate();
  for (itk::ImageRegionIterator<Field> at(image, image->GetBufferedRegion()); !at.IsAtEnd(); ++at) {
    Place place;
    image->TransformIndexToPhysicalPoint(at.GetIndex(), place);
    at.Set(place.GetVectorFromOrigin());
  }
  return image;
}

Field::Pointer moved(const Field& places, const Transform& transform) {
  const auto found = Field::New();
  found->CopyInformation(&places);
  found->SetRegions(places.GetLargestPossibleRegion());
  found->Allocate();
  for (itk::ImageRegionIterator<Field> at(found, found->GetBufferedRegion()); !at.IsAtEnd(); ++at) {
    Place place;
    found->TransformIndexToPhysicalPoint(at.GetIndex(), place);
    at.Set(transform.TransformPoint(place).GetVectorFromOrigin());
  }
  return found;
}

Field::Pointer resampled(const Field& places, const Transform& transform, const Field& field) {
  const auto filter = itk::ResampleImageFilter<Field, Field, double, double>::New();
  filter->SetInput(image_of_places(field));
  filter->SetTransform(&transform);
  filter->SetOutputParametersFromImage(&places);
  filter->SetSize(places.GetLargestPossibleRegion().GetSize());
  filter->Update();
  return filter->GetOutput();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) {
    std::cerr << "usage: itk_displacements move|resample IMAGE lps|ras PLACES.obj FOUND.obj\n";
    return 1;
  }
  const double sign = std::string(argv[3]) == "ras" ? -1 : 1;
  const auto write = [sign](std::ostream& out, const itk::Vector<double, 3>& lps) {
    out << "v " << sign * lps[0] << ' ' << sign * lps[1] << ' ' << lps[2] << '\n';
  };
  const Field::Pointer field = read_displacements(argv[2]);
  const auto transform = Transform::New();
  transform->SetDisplacementField(field);
  const Field::Pointer places = places_in(*field);
  const Field::Pointer found =
      std::string(argv[1]) == "move" ? moved(*places, *transform) : resampled(*places, *transform, *field);
  std::ofstream at_file(argv[4]), found_file(argv[5]);
  at_file.precision(std::numeric_limits<double>::max_digits10);
  found_file.precision(std::numeric_limits<double>::max_digits10);
  for (itk::ImageRegionConstIteratorWithIndex<Field> at(found, found->GetBufferedRegion()); !at.IsAtEnd();
       ++at) {
    Place place;
    places->TransformIndexToPhysicalPoint(at.GetIndex(), place);
    write(at_file, place.GetVectorFromOrigin());
    write(found_file, at.Get());
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
