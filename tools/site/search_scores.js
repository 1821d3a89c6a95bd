/** Pages of prose come before those of the reference, which have every name of the library. */
var Scorer = {
  score: ([docname, title, anchor, descr, score]) => (docname.startsWith("reference/") ? score - 30 : score),
  // Sphinx's own:
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
