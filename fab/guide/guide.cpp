// guide.html and guide.pdf: one document, written twice.

#include "fab/guide/content.h"
#include "fab/guide/html.h"
#include "fab/guide/pdf.h"
#include "fab/package/package_files.h"

namespace leafcutter::fab {

GuideFiles guide_files(const JobResult& job) {
    const guide::Document document = guide::make_guide(job);
    return {guide::write_html(document), guide::write_pdf(document)};
}

}  // namespace leafcutter::fab
