// The reference of the scene format, made from the schema.
#pragma once

#include <string>

namespace palpate::scene {

/// Markdown: one table per object, with every key, its type and unit, range, default and meaning,
/// and the rules across keys. docs/scene.md holds it word by word.
std::string schema_reference();

}  // namespace palpate::scene
