// usage: node validate.js FILE: prints what the Khronos validator finds, one line each; the last line is
// "N errors, N warnings". Without FILE it only exits with 0 where the package is installed, with 2 where it is not.
const fs = require("fs");
const path = require("path");

let validator;
try {
  validator = require("gltf-validator");
} catch (error) {
  process.exit(2);
}
const file = process.argv[2];
if (!file) process.exit(0);
const beside = (uri) => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri)));
validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {externalResourceFunction: beside}).then((report) => {
  for (const issue of report.issues.messages) console.log(issue.code, issue.pointer, issue.message);
  console.log(`${report.issues.numErrors} errors, ${report.issues.numWarnings} warnings`);
});
